/* What an expert writes by hand: Dormand and Prince's pair of order 8(5,3) with the right-hand side inlined, and dense
   output of order 7 only where an event may lie in the step (a change of sign, or a gap that falls at the left end and
   rises at the right).

   dop853 WORK REPETITIONS prints one line of JSON for each tolerance. */
#include "problems.h"
#include "report.h"
#include "stages.h"

#define N_MAX MOST_COMPONENTS

typedef void (*Rhs)(const double *, double *);
typedef void (*Events)(const double *, double *);
typedef void (*EventRates)(const double *, const double *, double *);
typedef void (*Impact)(int, double *);

INL void dense_at(int n, double dense[7][N_MAX], const double *y, double x, double *out) {
    for (int i = 0; i < n; i++) out[i] = 0;
    for (int q = 0; q < 7; q++) {
        double factor = (q & 1) ? 1 - x : x;
        for (int i = 0; i < n; i++) out[i] = (out[i] + dense[6 - q][i]) * factor;
    }
    for (int i = 0; i < n; i++) out[i] += y[i];
}

INL double first_step(int n, Rhs f, const double *y, const double *rate, double tol) {
    double a = 0, b = 0, c = 0, next[N_MAX], next_rate[N_MAX];
    for (int i = 0; i < n; i++) {
        double s = tol + tol * fabs(y[i]);
        a += y[i] * y[i] / (s * s);
        b += rate[i] * rate[i] / (s * s);
    }
    a = sqrt(a / n);
    b = sqrt(b / n);
    double h0 = (a < 1e-5 || b < 1e-5) ? 1e-6 : 0.01 * a / b;
    for (int i = 0; i < n; i++) next[i] = y[i] + h0 * rate[i];
    f(next, next_rate);
    for (int i = 0; i < n; i++) {
        double q = (next_rate[i] - rate[i]) / (tol + tol * fabs(y[i]));
        c += q * q;
    }
    c = sqrt(c / n) / h0;
    double most = b > c ? b : c;
    double h1 = most <= 1e-15 ? fmax(1e-6, h0 * 1e-3) : pow(0.01 / most, 1.0 / 8);
    return fmin(100 * h0, h1);
}

/* The first zero of event e in the step, as a part of it; 2 if there is none. A root at the start that was just left
   is divided out. */
INL double root(int n, int e, Events g, double dense[7][N_MAX], const double *y, double h, double t, double g0,
                double d0, double g1, double d1) {
    const int is_left = d0 > 0 && fabs(g0) < 1e-11;
    double a = 0, b = (g1 < 0 && (is_left || g0 >= 0)) ? 1 : -1, z[N_MAX], gaps[2];
#define VALUE(x, v)                                                                                                    \
    {                                                                                                                  \
        dense_at(n, dense, y, x, z);                                                                                   \
        g(z, gaps);                                                                                                    \
        v = is_left ? (gaps[e] - g0) / (x) : gaps[e];                                                                  \
    }
    if (b < 0 && !(d0 < 0 && d1 > 0)) return 2;
    for (int q = 1; q <= 4; q++) {
        double x = 0.2 * q;
        dense_at(n, dense, y, x, z);
        g(z, gaps);
        if (gaps[e] < 0) {
            b = x;
            break;
        }
        a = x;
    }
    if (b < 0) return 2;
    double fa = is_left ? d0 * h : g0, fb;
    if (a != 0) VALUE(a, fa)
    VALUE(b, fb)
    /* Illinois, with bisection every eighth time. */
    int side = 0;
    for (int k = 0; k < 60 && (b - a) * h > 1e-16 * fmax(1e-3, fabs(t)); k++) {
        double x = (k % 8 == 7) ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa), fx;
        if (!(x > a && x < b)) x = 0.5 * (a + b);
        if (x == a || x == b) break;
        VALUE(x, fx)
        if (fx == 0) return x;
        if (fx < 0) {
            b = x;
            fb = fx;
            if (side == -1) fa *= 0.5;
            side = -1;
        } else {
            a = x;
            fa = fx;
            if (side == 1) fb *= 0.5;
            side = 1;
        }
    }
    return b;
#undef VALUE
}

/* Runs y to t_end, or until |y[1]| < least_speed after an impact. */
INL void integrate(const int n, const int events, Rhs f, Events g, EventRates gd, Impact impact, double *y, double t_end,
                   double tol, double least_speed, Course *course) {
    double k[16][N_MAX] = {{0}}, yt[N_MAX], yn[N_MAX], dense[7][N_MAX], g0[2], g1[2], d0[2], d1[2], t = 0;
    course->evaluations = 2;
    course->accepted = course->rejected = course->events = 0;
    f(y, k[0]);
    double h = first_step(n, f, y, k[0], tol);
    if (events) {
        g(y, g0);
        gd(y, k[0], d0);
    }
    while (t < t_end && h >= 1e-15 * fmax(1, t)) {
        if (t + h > t_end) h = t_end - t;
        STAGES(f)
        course->evaluations += 12;
        double s3 = 0, s5 = 0;
        for (int i = 0; i < n; i++) {
            double e3, e5, scale = 1 / (tol + tol * fmax(fabs(y[i]), fabs(yn[i])));
            ERRORS(e3, e5)
            e3 *= scale;
            e5 *= scale;
            s3 += e3 * e3;
            s5 += e5 * e5;
        }
        double error = (s5 == 0 && s3 == 0) ? 0 : h * s5 / sqrt((s5 + 0.01 * s3) * n);
        if (!(error < 1)) {
            course->rejected++;
            h *= fmax(0.2, 0.9 * pow(error, -0.125));
            continue;
        }
        double factor = error == 0 ? 10 : fmin(10, 0.9 * pow(error, -0.125)), part = 2;
        int hit = -1, near = 0;
        course->accepted++;
        if (events) {
            g(yn, g1);
            gd(yn, k[12], d1);
            for (int e = 0; e < events; e++) near |= g1[e] < 0 || (d0[e] < 0 && d1[e] > 0);
        }
        if (near) {
            DENSE(f)
            course->evaluations += 3;
            for (int e = 0; e < events; e++) {
                double x = root(n, e, g, dense, y, h, t, g0[e], d0[e], g1[e], d1[e]);
                if (x < part) {
                    part = x;
                    hit = e;
                }
            }
        }
        if (hit < 0) {
            t += h;
            memcpy(y, yn, n * sizeof *y);
            memcpy(k[0], k[12], n * sizeof *y);
            memcpy(g0, g1, sizeof g0);
            memcpy(d0, d1, sizeof d0);
            h *= factor;
            continue;
        }
        double z[N_MAX];
        dense_at(n, dense, y, part, z);
        t += part * h;
        memcpy(y, z, n * sizeof *y);
        impact(hit, y);
        record(course, t, y, n);
        f(y, k[0]);
        course->evaluations++;
        g(y, g0);
        gd(y, k[0], d0);
        for (int e = 0; e < events; e++)
            if (g0[e] < 0 && g0[e] > -1e-9) g0[e] = 0;
        h = fmin(h * factor, h);
        if (fabs(y[1]) < least_speed) return;
    }
}

typedef void (*Run)(double *y, double t_end, double tol, double least_speed, Course *course);
#define RUN(NAME, n, events, f, g, gd, impact)                                                                         \
    static __attribute__((noinline)) void NAME(double *y, double t_end, double tol, double least_speed,                \
                                               Course *course) {                                                       \
        integrate(n, events, f, g, gd, impact, y, t_end, tol, least_speed, course);                                    \
    }
RUN(run_w1, 8, 2, w1_rhs, w1_ev, w1_evdot, w1_imp)
RUN(run_w1r, 6, 2, w1r_rhs, w1_ev, w1_evdot, w1r_imp)
RUN(run_w2, 6, 0, w2_rhs, w2_ev, w2_evdot, w2_imp)
RUN(run_w2b, 6, 2, w2_rhs, w2_ev, w2_evdot, w2_imp)
RUN(run_w3, 4, 0, w3_rhs, w2_ev, w2_evdot, w2_imp)
RUN(run_w4, 2, 1, w4_rhs, w4_ev, w4_evdot, w4_imp)

static void measure(const char *work, int n, Run run, void (*init)(double *), double (*energy)(const double *),
                    double t_end, double least_speed, int repetitions, const double *probes, int probe_count) {
    static Course course;
    for (int q = 0; q < TOLERANCE_COUNT; q++) {
        double tol = TOLERANCES[q], y[N_MAX], start[N_MAX], time = INFINITY;
        init(start);
        for (int r = 0; r < repetitions; r++) {
            memcpy(y, start, sizeof y);
            double begin = now();
            run(y, t_end, tol, least_speed, &course);
            keep_least(&time, now() - begin);
        }
        printf("{\"peer\":\"hand-dop853\",\"work\":\"%s\",\"tol\":%g,\"T\":%g,\"time\":%.6e,\"nf\":%ld,\"acc\":%ld,"
               "\"rej\":%ld,\"nev\":%ld,",
               work, tol, t_end, time, course.evaluations, course.accepted, course.rejected,
               course.events);
        if (energy) printf("\"dE\":%.3e,", (energy(y) - energy(start)) / fabs(energy(start)));
        printf("\"y\":");
        print_vector(y, n);
        printf(",");
        print_impacts(&course, n);
        printf(",\"probe\":[");
        for (int a = 0; a < probe_count; a++) {
            init(y);
            run(y, probes[a], tol, least_speed, &course);
            printf(a ? "," : "");
            print_vector(y, n);
        }
        printf("]}\n");
        fflush(stdout);
    }
}

static void measure_ensemble(const char *work, Run run, void (*start)(double *, double), int repetitions) {
    static Course course;
    static double ends[TRAJECTORIES];
    for (int q = 0; q < ENSEMBLE_COUNT; q++) {
        double times[PARTS];
        Course sum = {0};
        for (int part = 0; part < PARTS; part++) times[part] = INFINITY;
        for (int r = 0; r < repetitions; r++) {
            sum.events = sum.evaluations = 0;
            for (int part = 0; part < PARTS; part++) {
                double begin = now();
                for (int k = part * PART; k < (part + 1) * PART; k++) {
                    double y[N_MAX];
                    start(y, rolling_rate(k));
                    run(y, 10, ENSEMBLE_TOLERANCES[q], 0, &course);
                    ends[k] = y[0];
                    sum.events += course.events;
                    sum.evaluations += course.evaluations;
                }
                keep_least(&times[part], now() - begin);
            }
        }
        print_ensemble("hand-dop853", work, ENSEMBLE_TOLERANCES[q], times, &sum, ends);
    }
}

int main(int count, char **arguments) {
    if (count != 3) return fprintf(stderr, "dop853 WORK REPETITIONS\n"), 2;
    const char *work = arguments[1];
    int repetitions = atoi(arguments[2]);
    const double far[] = {1, 10, 100}, near[] = {1, 10, 20};
#define IS(name) !strcmp(work, name)
    if (IS("W1")) measure(work, 8, run_w1, w1_init, w1_energy, 200, 0, repetitions, 0, 0);
    if (IS("W1r")) measure(work, 6, run_w1r, w1r_init, w1r_energy, 200, 0, repetitions, 0, 0);
    if (IS("W2")) measure(work, 6, run_w2, w2_init, w2_energy, 1000, 0, repetitions, far, 3);
    if (IS("W2b")) measure(work, 6, run_w2b, w2b_init, w2_energy, 200, 0, repetitions, 0, 0);
    if (IS("W3")) measure(work, 4, run_w3, w3_init, w3_energy, 100, 0, repetitions, near, 3);
    if (IS("W4")) measure(work, 2, run_w4, w4_init, 0, 20, 1e-12, repetitions, 0, 0);
    if (IS("W5")) measure_ensemble(work, run_w1, w1_start, repetitions);
    if (IS("W5r")) measure_ensemble(work, run_w1r, w1r_start, repetitions);
}
