/* The right-hand side of the chain of N unit masses on unit rods by hand, state (theta, omega): with the mass matrix
   factorised, O(N^3), and with the tensions of the rods from a tridiagonal system, O(N). A shared library. */
#include "problems.h"
#include "report.h"

#define G 9.81

/* M_ij = (N - max(i, j)) cos(theta_i - theta_j), counted from 0, by L D L^T. */
#define DENSE(N)                                                                                                       \
    static __attribute__((noinline)) void dense_##N(const double *y, double *d) {                                      \
        double s[N], c[N], a[N][N], b[N];                                                                              \
        for (int i = 0; i < N; i++) sincos(y[i], &s[i], &c[i]);                                                        \
        for (int i = 0; i < N; i++) {                                                                                  \
            double r = -G * (N - i) * s[i];                                                                            \
            for (int j = 0; j < N; j++) {                                                                              \
                int k = i > j ? i : j;                                                                                 \
                double cosine = c[i] * c[j] + s[i] * s[j], sine = s[i] * c[j] - c[i] * s[j];                           \
                r -= (N - k) * sine * y[N + j] * y[N + j];                                                             \
                if (j <= i) a[i][j] = (N - i) * cosine;                                                                \
            }                                                                                                          \
            b[i] = r;                                                                                                  \
            d[i] = y[N + i];                                                                                           \
        }                                                                                                              \
        for (int j = 0; j < N; j++) {                                                                                  \
            double p = 1 / a[j][j];                                                                                    \
            for (int i = j + 1; i < N; i++) {                                                                          \
                double l = a[i][j] * p;                                                                                \
                for (int k = j + 1; k <= i; k++) a[i][k] -= l * a[k][j];                                               \
                b[i] -= l * b[j];                                                                                      \
            }                                                                                                          \
        }                                                                                                              \
        for (int i = N - 1; i >= 0; i--) {                                                                             \
            double r = b[i];                                                                                           \
            for (int k = i + 1; k < N; k++) r -= a[k][i] * b[k];                                                       \
            b[i] = r / a[i][i];                                                                                        \
            d[N + i] = b[i];                                                                                           \
        }                                                                                                              \
    }

/* Tension T_i of rod i, u_i = (sin, -cos) along it: (a_i - a_{i-1}).u_i = -omega_i^2 with a_i = -g e_y - T_i u_i +
   T_{i+1} u_{i+1}. Then omega_i' = (a_i - a_{i-1}).t_i with t_i = (cos, sin). */
#define TENSIONS(N)                                                                                                    \
    static __attribute__((noinline)) void tensions_##N(const double *y, double *d) {                                   \
        double s[N], c[N], upper[N], right[N], tension[N], cosine[N], sine[N];                                         \
        for (int i = 0; i < N; i++) sincos(y[i], &s[i], &c[i]);                                                        \
        for (int i = 0; i + 1 < N; i++) {                                                                              \
            cosine[i] = c[i] * c[i + 1] + s[i] * s[i + 1];                                                             \
            sine[i] = s[i + 1] * c[i] - c[i + 1] * s[i];                                                               \
        }                                                                                                              \
        cosine[N - 1] = sine[N - 1] = 0;                                                                               \
        upper[0] = -cosine[0];                                                                                         \
        right[0] = y[N] * y[N] + G * c[0];                                                                             \
        for (int i = 1; i < N; i++) {                                                                                  \
            double lower = -cosine[i - 1], scale = 1 / (2 - lower * upper[i - 1]);                                     \
            upper[i] = -cosine[i] * scale;                                                                             \
            right[i] = (y[N + i] * y[N + i] - lower * right[i - 1]) * scale;                                           \
        }                                                                                                              \
        tension[N - 1] = right[N - 1];                                                                                 \
        for (int i = N - 2; i >= 0; i--) tension[i] = right[i] - upper[i] * tension[i + 1];                            \
        for (int i = 0; i < N; i++) {                                                                                  \
            double r = i == 0 ? -G * s[0] : 0;                                                                         \
            if (i + 1 < N) r += tension[i + 1] * sine[i];                                                              \
            if (i > 0) r -= tension[i - 1] * sine[i - 1];                                                              \
            d[i] = y[N + i];                                                                                           \
            d[N + i] = r;                                                                                              \
        }                                                                                                              \
    }

#define SIZES(X) X(2) X(4) X(8) X(16) X(32)
SIZES(DENSE)
SIZES(TENSIONS)

typedef void (*Rate)(const double *, double *);

static Rate find(int is_dense, int n) {
    switch (n) {
#define CASE(N)                                                                                                        \
    case N: return is_dense ? dense_##N : tensions_##N;
        SIZES(CASE)
    }
    return 0;
}

void evaluate(int is_dense, int n, const double *y, double *d) { find(is_dense, n)(y, d); }

/* Nanoseconds of one evaluation: the mean over all states, several times. */
double nanoseconds(int is_dense, int n, const double *states, int count, int times) {
    static double d[64];
    Rate rate = find(is_dense, n);
    double begin = now();
    for (int r = 0; r < times; r++)
        for (int k = 0; k < count; k++) {
            rate(states + k * 2 * n, d);
            __asm__ volatile("" ::"r"(d) : "memory");
        }
    return (now() - begin) / times / count * 1e9;
}
