/* Work items W1..W5: hand-derived right-hand sides, event functions and impact maps.
   Everything is `static inline` so that a specialised integrator can inline it. */
#ifndef PROBLEMS_H
#define PROBLEMS_H
#define _GNU_SOURCE
#include <math.h>
#define INL static inline __attribute__((always_inline))
/* ---------- W1 rolling disk, state x y th ph vx vy w Om (8) ---------- */
#define W1_m 0.0025
#define W1_R 0.01
#define W1_I 1.25e-7
#define W1_J 6.25e-8
#define W1_a 0.15
#define W1_b 0.20
INL void w1_rhs(const double *y, double *d) { /* general form: 2x2 multiplier solve */
    double s, c;
    sincos(y[3], &s, &c);
    const double im = 1 / W1_m, k = W1_R * W1_R / W1_I;
    double G11 = im + k * c * c, G12 = k * s * c, G22 = im + k * s * s;
    double g1 = W1_R * s * y[7] * y[6], g2 = -W1_R * c * y[7] * y[6];
    double id = 1 / (G11 * G22 - G12 * G12);
    double l1 = -(G22 * g1 - G12 * g2) * id, l2 = -(G11 * g2 - G12 * g1) * id;
    d[0] = y[4];
    d[1] = y[5];
    d[2] = y[6];
    d[3] = y[7];
    d[4] = l1 * im;
    d[5] = l2 * im;
    d[6] = -(W1_R / W1_I) * (c * l1 + s * l2);
    d[7] = 0;
}
INL void w1_ev(const double *y, double *g) {
    double s, c;
    sincos(y[3], &s, &c);
    const double ia = 1 / (W1_a * W1_a), ib = 1 / (W1_b * W1_b);
    double X = y[0] + W1_R * c, Y = y[1] + W1_R * s;
    g[0] = 1 - X * X * ia - Y * Y * ib;
    X = y[0] - W1_R * c;
    Y = y[1] - W1_R * s;
    g[1] = 1 - X * X * ia - Y * Y * ib;
}
INL void w1_evdot(const double *y, const double *d, double *g) { /* time derivative of the events */
    double s, c;
    sincos(y[3], &s, &c);
    const double ia = 1 / (W1_a * W1_a), ib = 1 / (W1_b * W1_b);
    double X = y[0] + W1_R * c, Y = y[1] + W1_R * s;
    g[0] = -2 * (X * ia * (d[0] - W1_R * s * d[3]) + Y * ib * (d[1] + W1_R * c * d[3]));
    X = y[0] - W1_R * c;
    Y = y[1] - W1_R * s;
    g[1] = -2 * (X * ia * (d[0] + W1_R * s * d[3]) + Y * ib * (d[1] - W1_R * c * d[3]));
}
INL void w1_imp(int e, double *y) { /* elastic, v+ = v - 2 dh(v)/dh(n) n, n = pi_D grad h */
    double s, c;
    sincos(y[3], &s, &c);
    double r = e == 0 ? W1_R : -W1_R;
    double X = y[0] + r * c, Y = y[1] + r * s, hx = -2 * X / (W1_a * W1_a), hy = -2 * Y / (W1_b * W1_b);
    double hw = W1_R * (hx * c + hy * s), hO = r * (-s * hx + c * hy);
    double A = W1_I + W1_m * W1_R * W1_R, nw = hw / A, nO = hO / W1_J;
    double k = 2 * (hw * y[6] + hO * y[7]) / (hw * nw + hO * nO);
    y[6] -= k * nw;
    y[7] -= k * nO;
    y[4] = W1_R * c * y[6];
    y[5] = W1_R * s * y[6];
}
static double w1_energy(const double *y) {
    return 0.5 * (W1_m * (y[4] * y[4] + y[5] * y[5]) + W1_I * y[6] * y[6] + W1_J * y[7] * y[7]);
}
static void w1_start(double *y, double w) {
    double s, c;
    y[0] = y[1] = y[2] = 0;
    y[3] = M_PI / 2;
    sincos(y[3], &s, &c);
    y[4] = W1_R * c * w;
    y[5] = W1_R * s * w;
    y[6] = w;
    y[7] = 0.2;
}
static void w1_init(double *y) { w1_start(y, 10); }
/* reduced form on D: state x y th ph w Om (6) */
INL void w1r_rhs(const double *y, double *d) {
    double s, c;
    sincos(y[3], &s, &c);
    d[0] = W1_R * c * y[4];
    d[1] = W1_R * s * y[4];
    d[2] = y[4];
    d[3] = y[5];
    d[4] = 0;
    d[5] = 0;
}
INL void w1r_imp(int e, double *y) {
    double z[8] = {y[0], y[1], y[2], y[3], 0, 0, y[4], y[5]};
    w1_imp(e, z);
    y[4] = z[6];
    y[5] = z[7];
}
static double w1r_energy(const double *y) {
    return 0.5 * ((W1_I + W1_m * W1_R * W1_R) * y[4] * y[4] + W1_J * y[5] * y[5]);
}
static void w1r_start(double *y, double w) {
    y[0] = y[1] = y[2] = 0;
    y[3] = M_PI / 2;
    y[4] = w;
    y[5] = 0.2;
}
static void w1r_init(double *y) { w1r_start(y, 10); }

/* ---------- W2 Chaplygin sleigh, state x y th vx vy Om (6) ---------- */
#define W2_m 1.0
#define W2_I 1.0
#define W2_a 0.3
#define W2_A 3.0
#define W2_B 4.0
#define W2_L 0.5
INL void w2_rhs(const double *y, double *d) { /* general: 4x4 saddle solved by m^{ab} */
    double s, c;
    sincos(y[2], &s, &c);
    const double m = W2_m, a = W2_a, I = W2_I;
    double vx = y[3], vy = y[4], O = y[5];
    /* M a = f + eta^T lam, eta = (-s, c, 0), f = (m a c O^2, m a s O^2, 0);
       M^{-1} r: alpha = (r3 + a (s r1 - c r2))/I, ax = r1/m + a s alpha, ay = r2/m - a c alpha */
    double iI = 1 / I, im = 1 / m;
    double f1 = m * a * c * O * O, f2 = m * a * s * O * O;
    double al = a * (s * f1 - c * f2) * iI, b1 = f1 * im + a * s * al, b2 = f2 * im - a * c * al;
    double wal = -a * (s * s + c * c) * iI, w1 = -s * im + a * s * wal, w2 = c * im - a * c * wal;
    double mm = -s * w1 + c * w2, gam = -c * O * vx - s * O * vy;
    double lam = -(gam - s * b1 + c * b2) / mm;
    d[0] = vx;
    d[1] = vy;
    d[2] = O;
    d[3] = b1 + w1 * lam;
    d[4] = b2 + w2 * lam;
    d[5] = al + wal * lam;
}
INL void w2_ev(const double *y, double *g) {
    double s, c;
    sincos(y[2], &s, &c);
    const double ia = 1 / (W2_A * W2_A), ib = 1 / (W2_B * W2_B);
    double X = y[0] + W2_L * c, Y = y[1] + W2_L * s;
    g[0] = 1 - X * X * ia - Y * Y * ib;
    X = y[0] - W2_L * c;
    Y = y[1] - W2_L * s;
    g[1] = 1 - X * X * ia - Y * Y * ib;
}
INL void w2_evdot(const double *y, const double *d, double *g) {
    double s, c;
    sincos(y[2], &s, &c);
    const double ia = 1 / (W2_A * W2_A), ib = 1 / (W2_B * W2_B);
    double X = y[0] + W2_L * c, Y = y[1] + W2_L * s;
    g[0] = -2 * (X * ia * (d[0] - W2_L * s * d[2]) + Y * ib * (d[1] + W2_L * c * d[2]));
    X = y[0] - W2_L * c;
    Y = y[1] - W2_L * s;
    g[1] = -2 * (X * ia * (d[0] + W2_L * s * d[2]) + Y * ib * (d[1] - W2_L * c * d[2]));
}
INL void w2_imp(int e, double *y) {
    double s, c;
    sincos(y[2], &s, &c);
    double L = e == 0 ? W2_L : -W2_L;
    double X = y[0] + L * c, Y = y[1] + L * s, hx = -2 * X / (W2_A * W2_A), hy = -2 * Y / (W2_B * W2_B);
    double hv = hx * c + hy * s, hO = L * (-s * hx + c * hy), nv = hv / W2_m,
           nO = hO / (W2_I + W2_m * W2_a * W2_a);
    double v = c * y[3] + s * y[4], O = y[5], k = 2 * (hv * v + hO * O) / (hv * nv + hO * nO);
    v -= k * nv;
    O -= k * nO;
    y[3] = v * c;
    y[4] = v * s;
    y[5] = O;
}
static double w2_energy(const double *y) {
    double v2 = y[3] * y[3] + y[4] * y[4];
    return 0.5 * (W2_m * v2 + (W2_I + W2_m * W2_a * W2_a) * y[5] * y[5] +
                  2 * W2_m * W2_a * y[5] * (-y[3] * sin(y[2]) + y[4] * cos(y[2])));
}
/* the free sleigh: it turns round once */
static void w2_init(double *y) {
    y[0] = y[1] = y[2] = 0;
    y[3] = -1;
    y[4] = 0;
    y[5] = 0.2;
}
static void w2b_init(double *y) {
    double s, c;
    y[0] = y[1] = 0;
    y[2] = 0.3;
    sincos(y[2], &s, &c);
    y[3] = c;
    y[4] = s;
    y[5] = 1;
}

/* ---------- W3 planar double pendulum, absolute angles, state t1 t2 w1 w2 ---------- */
#define W3_g 9.81
INL void w3_rhs(const double *y, double *d) { /* m1=m2=1, l1=l2=1 */
    double s1, c1, s2, c2;
    sincos(y[0], &s1, &c1);
    sincos(y[1], &s2, &c2);
    double C = c1 * c2 + s1 * s2, S = s1 * c2 - c1 * s2;
    double r1 = -S * y[3] * y[3] - 2 * W3_g * s1, r2 = S * y[2] * y[2] - W3_g * s2;
    double id = 1 / (2 - C * C);
    d[0] = y[2];
    d[1] = y[3];
    d[2] = (r1 - C * r2) * id;
    d[3] = (2 * r2 - C * r1) * id;
}
static double w3_energy(const double *y) {
    return y[2] * y[2] + 0.5 * y[3] * y[3] + y[2] * y[3] * cos(y[0] - y[1]) -
           W3_g * (2 * cos(y[0]) + cos(y[1]));
}
static void w3_init(double *y) {
    y[0] = 2.0;
    y[1] = 2.5;
    y[2] = 0;
    y[3] = 0;
}

/* ---------- W4 bouncing ball, restitution 0.9, h0=1, g=9.81 ---------- */
#define W4_e 0.9
#define W4_g 9.81
INL void w4_rhs(const double *y, double *d) {
    d[0] = y[1];
    d[1] = -W4_g;
}
INL void w4_ev(const double *y, double *g) { g[0] = y[0]; }
INL void w4_evdot(const double *y, const double *d, double *g) {
    (void)y;
    g[0] = d[0];
}
INL void w4_imp(int e, double *y) {
    (void)e;
    y[0] = 0;
    y[1] = -W4_e * y[1];
}
static void w4_init(double *y) {
    y[0] = 1;
    y[1] = 0;
}
#endif
