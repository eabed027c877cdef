/* Timing, and a course as one line of JSON. */
#ifndef REPORT_H
#define REPORT_H
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#define MOST_COMPONENTS 8
#define MOST_EVENTS 600

static const double TOLERANCES[] = {1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14};
enum { TOLERANCE_COUNT = sizeof TOLERANCES / sizeof *TOLERANCES };
static const double ENSEMBLE_TOLERANCES[] = {1e-3, 1e-4, 1e-6, 1e-9, 1e-12};
enum { ENSEMBLE_COUNT = sizeof ENSEMBLE_TOLERANCES / sizeof *ENSEMBLE_TOLERANCES };
/* The ensemble is timed in parts, short enough for some repetition of each to be undisturbed. */
enum { TRAJECTORIES = 10000, SAMPLES = 10, PARTS = 125, PART = TRAJECTORIES / PARTS };

typedef struct {
    long evaluations, accepted, rejected, events;
    double times[MOST_EVENTS], states[MOST_EVENTS][MOST_COMPONENTS];
} Course;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}
static void keep_least(double *least, double value) {
    if (value < *least) *least = value;
}
static void record(Course *course, double t, const double *y, int n) {
    if (course->events < MOST_EVENTS) {
        course->times[course->events] = t;
        memcpy(course->states[course->events], y, n * sizeof *y);
    }
    course->events++;
}
static void print_vector(const double *v, int n) {
    printf("[");
    for (int i = 0; i < n; i++) printf("%s%.17g", i ? "," : "", v[i]);
    printf("]");
}
/* Times of impacts, and the states after impacts 1, 5, 10 and 20. */
static void print_impacts(const Course *course, int n) {
    const int which[] = {0, 4, 9, 19};
    int count = course->events < MOST_EVENTS ? course->events : MOST_EVENTS;
    printf("\"tev\":");
    print_vector(course->times, count);
    printf(",\"yev\":[");
    for (int k = 0; k < 4 && which[k] < count; k++) {
        printf(k ? "," : "");
        print_vector(course->states[which[k]], n);
    }
    printf("]");
}
static double rolling_rate(int trajectory) {
    return 10 + 0.005 * (2.0 * trajectory / (TRAJECTORIES - 1) - 1);
}
static void print_ensemble(const char *peer, const char *work, double tolerance, const double *times,
                           const Course *sum, const double *ends) {
    double samples[SAMPLES], total = 0, time = 0;
    for (int k = 0; k < PARTS; k++) time += times[k];
    for (int k = 0; k < TRAJECTORIES; k++) total += ends[k];
    for (int k = 0; k < SAMPLES; k++) samples[k] = ends[k * ((TRAJECTORIES - 1) / (SAMPLES - 1))];
    printf("{\"peer\":\"%s\",\"work\":\"%s\",\"tol\":%g,\"time\":%.6e,\"n\":%d,\"nev\":%ld,\"nf\":%ld,"
           "\"sumx\":%.15g,\"samples\":",
           peer, work, tolerance, time, TRAJECTORIES, sum->events, sum->evaluations, total);
    print_vector(samples, SAMPLES);
    printf("}\n");
    fflush(stdout);
}
#endif
