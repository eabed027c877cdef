/* SUNDIALS: CVODE (Adams, fixed-point iteration) and ARKODE (explicit Runge-Kutta, Verner 6(5)), each with its own
   search for roots, begun anew after every impact.

   sundials WORK REPETITIONS adams|erk prints one line of JSON for each tolerance.

   ARKODE's Fehlberg 8(7) table is not used: its error estimate vanishes on motions that are quadratures (W1). */
#include "problems.h"
#include "report.h"
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#define MANY_STEPS 100000000
#define MANY_IMPACTS 3000

typedef struct {
    const char *work;
    int n, events;
    void (*rhs)(const double *, double *);
    void (*gaps)(const double *, double *);
    void (*impact)(int, double *);
    void (*init)(double *);
    double (*energy)(const double *);
    double until, probes[3];
} Problem;

static const Problem PROBLEMS[] = {
    {"W1", 8, 2, w1_rhs, w1_ev, w1_imp, w1_init, w1_energy, 200, {0}},
    {"W1r", 6, 2, w1r_rhs, w1_ev, w1r_imp, w1r_init, w1r_energy, 200, {0}},
    {"W2", 6, 0, w2_rhs, 0, 0, w2_init, w2_energy, 1000, {1, 10, 100}},
    {"W2b", 6, 2, w2_rhs, w2_ev, w2_imp, w2b_init, w2_energy, 200, {0}},
    {"W3", 4, 0, w3_rhs, 0, 0, w3_init, w3_energy, 100, {1, 10, 20}},
    {"W4", 2, 1, w4_rhs, w4_ev, w4_imp, w4_init, 0, 20, {0}},
};
enum { PROBLEM_COUNT = sizeof PROBLEMS / sizeof *PROBLEMS };

static Course course;

static int rhs(double t, N_Vector y, N_Vector rate, void *problem) {
    (void)t;
    course.evaluations++;
    ((const Problem *)problem)->rhs(NV_DATA_S(y), NV_DATA_S(rate));
    return 0;
}
static int gaps(double t, N_Vector y, double *values, void *problem) {
    (void)t;
    ((const Problem *)problem)->gaps(NV_DATA_S(y), values);
    return 0;
}
static void silent(int code, const char *module, const char *function, char *message, void *data) {
    (void)code, (void)module, (void)function, (void)message, (void)data;
}

static void *create(const Problem *problem, int is_erk, N_Vector y, double tol, SUNNonlinearSolver *solver,
                    SUNContext context) {
    int directions[] = {-1, -1};
    void *memory = is_erk ? ERKStepCreate(rhs, 0, y, context) : CVodeCreate(CV_ADAMS, context);
#define CALL(name, ...) (is_erk ? ERKStep##name(memory, __VA_ARGS__) : CVode##name(memory, __VA_ARGS__))
    if (is_erk) {
        ERKStepSetTableNum(memory, ARKODE_VERNER_8_5_6);
    } else {
        CVodeInit(memory, rhs, 0, y);
        *solver = SUNNonlinSol_FixedPoint(y, 0, context);
    }
    CALL(SStolerances, tol, tol);
    CALL(SetUserData, (void *)problem);
    CALL(SetMaxNumSteps, MANY_STEPS);
    CALL(SetErrHandlerFn, silent, 0);
    CALL(SetStopTime, problem->until);
    if (!is_erk) CVodeSetNonlinearSolver(memory, *solver);
    if (problem->events) {
        CALL(RootInit, problem->events, gaps);
        CALL(SetRootDirection, directions);
        is_erk ? ERKStepSetNoInactiveRootWarn(memory) : CVodeSetNoInactiveRootWarn(memory);
    }
    return memory;
}

static long steps(void *memory, int is_erk) {
    long count = 0;
    CALL(GetNumSteps, &count);
    return count;
}

/* Runs `start` to `until`; the state there is left in it. */
static void run(const Problem *problem, int is_erk, double *start, double until, double tol, SUNContext context) {
    SUNNonlinearSolver solver = 0;
    N_Vector y = N_VNew_Serial(problem->n, context);
    double t = 0, *state = NV_DATA_S(y);
    long before = 0;
    memcpy(state, start, problem->n * sizeof *state);
    course.evaluations = course.events = 0;
    void *memory = create(problem, is_erk, y, tol, &solver, context);
    CALL(SetStopTime, until);
    while (t < until) {
        int status = is_erk ? ERKStepEvolve(memory, until, y, &t, ARK_NORMAL) : CVode(memory, until, y, &t, CV_NORMAL);
        if (status < 0) break;
        if (status != CV_ROOT_RETURN) continue;
        int roots[2] = {0, 0};
        CALL(GetRootInfo, roots);
        problem->impact(problem->events > 1 && roots[0] == 0, state);
        record(&course, t, state, problem->n);
        if (problem->events == 1 && (fabs(state[1]) < 1e-12 || course.events > MANY_IMPACTS)) break;
        if (!is_erk) before += steps(memory, is_erk);
        is_erk ? ERKStepReset(memory, t, y) : CVodeReInit(memory, t, y);
        CALL(SetStopTime, until);
    }
    course.accepted = before + steps(memory, is_erk);
    memcpy(start, state, problem->n * sizeof *state);
    N_VDestroy(y);
    is_erk ? ERKStepFree(&memory) : CVodeFree(&memory);
    if (solver) SUNNonlinSolFree(solver);
}

static void measure(const Problem *problem, int is_erk, int repetitions, SUNContext context) {
    const char *peer = is_erk ? "arkode-erk6" : "cvode-adams";
    for (int q = 0; q < TOLERANCE_COUNT; q++) {
        double y[MOST_COMPONENTS], start[MOST_COMPONENTS], time = INFINITY, tol = TOLERANCES[q];
        problem->init(start);
        for (int r = 0; r < repetitions; r++) {
            memcpy(y, start, sizeof y);
            double begin = now();
            run(problem, is_erk, y, problem->until, tol, context);
            keep_least(&time, now() - begin);
        }
        printf("{\"peer\":\"%s\",\"work\":\"%s\",\"tol\":%g,\"T\":%g,\"time\":%.6e,\"nf\":%ld,\"acc\":%ld,\"nev\":%ld,",
               peer, problem->work, tol, problem->until, time, course.evaluations,
               course.accepted, course.events);
        if (problem->energy)
            printf("\"dE\":%.3e,", (problem->energy(y) - problem->energy(start)) / fabs(problem->energy(start)));
        printf("\"y\":");
        print_vector(y, problem->n);
        printf(",");
        print_impacts(&course, problem->n);
        printf(",\"probe\":[");
        for (int a = 0; a < 3 && problem->probes[a] > 0; a++) {
            problem->init(y);
            run(problem, is_erk, y, problem->probes[a], tol, context);
            printf(a ? "," : "");
            print_vector(y, problem->n);
        }
        printf("]}\n");
        fflush(stdout);
    }
}

static void measure_ensemble(const char *work, int is_erk, int repetitions, SUNContext context) {
    static double ends[TRAJECTORIES];
    const int is_reduced = !strcmp(work, "W5r");
    for (int q = 0; q < ENSEMBLE_COUNT; q++) {
        double times[PARTS];
        Course sum = {0};
        for (int part = 0; part < PARTS; part++) times[part] = INFINITY;
        for (int r = 0; r < repetitions; r++) {
            sum.events = sum.evaluations = 0;
            for (int part = 0; part < PARTS; part++) {
                double begin = now();
                for (int k = part * PART; k < (part + 1) * PART; k++) {
                    double y[MOST_COMPONENTS];
                    (is_reduced ? w1r_start : w1_start)(y, rolling_rate(k));
                    run(&PROBLEMS[is_reduced], is_erk, y, 10, ENSEMBLE_TOLERANCES[q], context);
                    ends[k] = y[0];
                    sum.events += course.events;
                    sum.evaluations += course.evaluations;
                }
                keep_least(&times[part], now() - begin);
            }
        }
        print_ensemble(is_erk ? "arkode-erk6" : "cvode-adams", work, ENSEMBLE_TOLERANCES[q], times, &sum, ends);
    }
}

int main(int count, char **arguments) {
    if (count != 4) return fprintf(stderr, "sundials WORK REPETITIONS adams|erk\n"), 2;
    SUNContext context;
    SUNContext_Create(0, &context);
    const int repetitions = atoi(arguments[2]), is_erk = !strcmp(arguments[3], "erk");
    if (!strncmp(arguments[1], "W5", 2)) measure_ensemble(arguments[1], is_erk, repetitions, context);
    for (int k = 0; k < PROBLEM_COUNT; k++)
        if (!strcmp(PROBLEMS[k].work, arguments[1])) measure(&PROBLEMS[k], is_erk, repetitions, context);
}
