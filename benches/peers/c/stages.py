"""Writes stages.h: the stages of Dormand and Prince's pair 8(5,3), from the coefficients that SciPy ships."""

import sys
from pathlib import Path

from scipy.integrate._ivp import dop853_coefficients as pair

RATES = 16


def combination(row, count):
    """The sum of the first rates of a component, each times its coefficient."""
    terms = [f"{float(row[j])!r}*k[{j}][i]" for j in range(count) if row[j] != 0]
    return "+".join(terms) or "0"


def stage(target, row, count, rate):
    return f"for(int i=0;i<n;i++){target}[i]=y[i]+h*({combination(row, count)}); f({target},k[{rate}]);"


def macro(head, lines):
    return f"#define {head} \\\n" + " \\\n".join(f"  {line}" for line in lines) + "\n"


def header():
    stages = [stage("yt", pair.A[s], s, s) for s in range(1, 12)] + [stage("yn", pair.B, 12, 12)]
    errors = [f"e5={combination(pair.E5, 13)};", f"e3={combination(pair.E3, 13)};"]
    dense = [stage("yt", pair.A[s], s, s) for s in range(13, RATES)]
    dense.append("for(int i=0;i<n;i++){double dy=yn[i]-y[i]; dense[0][i]=dy; dense[1][i]=h*k[0][i]-dy;")
    dense.append("dense[2][i]=2*dy-h*(k[12][i]+k[0][i]);")
    dense += [f"dense[{3 + q}][i]=h*({combination(pair.D[q], RATES)});" for q in range(4)] + ["}"]
    return macro("STAGES(f)", stages) + macro("ERRORS(e3,e5)", errors) + macro("DENSE(f)", dense)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(header())
