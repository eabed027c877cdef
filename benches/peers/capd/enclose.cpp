// Enclosures by CAPD of the motions of `enclose.py`: problem, widths of its start, time -> width of the end and seconds.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "capd/capdlib.h"

using namespace capd;

struct Problem {
    const char *name;
    const char *field;
    std::vector<double> start;
};

// The double pendulum in angles and momenta: a' and b' from [2, c; c, 1] (a', b') = (p, q), c = cos(a - b).
static const Problem PROBLEMS[] = {
    {"rossler", "par:;var:x,y,z;fun:-(y+z),x+0.2*y,0.2+z*(x-5.7);", {0.0, -8.3809417428298, 0.029590060630665}},
    {"lorenz", "par:;var:x,y,z;fun:10*(y-x),x*(28-z)-y,x*y-8*z/3;", {1.0, 1.0, 1.0}},
    {"double_pendulum",
     "par:;var:a,b,p,q;fun:"
     "(p-cos(a-b)*q)/(1+sin(a-b)^2),"
     "(2*q-cos(a-b)*p)/(1+sin(a-b)^2),"
     "-(p-cos(a-b)*q)*(2*q-cos(a-b)*p)/(1+sin(a-b)^2)^2*sin(a-b)-19.62*sin(a),"
     "(p-cos(a-b)*q)*(2*q-cos(a-b)*p)/(1+sin(a-b)^2)^2*sin(a-b)-9.81*sin(b);",
     {1.0, 2.0, 0.0, 0.0}},
};

int main(int count, char **given) {
    if (count != 6) {
        std::fprintf(stderr, "usage: enclose PROBLEM HALF_WIDTH UNTIL ORDER TOLERANCE\n");
        return 2;
    }
    const double half_width = std::atof(given[2]), until = std::atof(given[3]), tolerance = std::atof(given[5]);
    for (const Problem &problem : PROBLEMS) {
        if (std::string(given[1]) != problem.name) {
            continue;
        }
        try {
            const auto begin = std::chrono::steady_clock::now();
            IMap field(problem.field);
            IOdeSolver solver(field, std::atoi(given[4]));
            solver.setAbsoluteTolerance(tolerance);
            solver.setRelativeTolerance(tolerance);
            ITimeMap motion(solver);
            IVector start(problem.start.size());
            for (size_t i = 0; i < problem.start.size(); i++) {
                start[i] = interval(problem.start[i]) + interval(-half_width, half_width);
            }
            C0HOTripletonSet set(start);
            const IVector end = motion(interval(until), set);
            const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
            double width = 0.0;
            for (size_t i = 0; i < problem.start.size(); i++) {
                width = std::max(width, end[i].rightBound() - end[i].leftBound());
            }
            std::printf("{\"width\": %.3e, \"seconds\": %.6f, \"end\": [", width, taken.count());
            for (size_t i = 0; i < problem.start.size(); i++) {
                std::printf("%s[%.17g, %.17g]", i ? ", " : "", end[i].leftBound(), end[i].rightBound());
            }
            std::printf("]}\n");
        } catch (const std::exception &fault) {
            std::fprintf(stderr, "%s\n", fault.what());
            return 1;
        }
        return 0;
    }
    std::fprintf(stderr, "no problem `%s`\n", given[1]);
    return 2;
}
