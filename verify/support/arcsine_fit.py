"""Coefficients of the arcsine polynomial in kinematics/fibre_frame.hpp ([K-4]).

asin(s) = s + s z P(z), z = s^2, on 0 <= z <= 1/4: Chebyshev interpolation of P in 60 digits,
expanded in powers of z and rounded to double. Needs python3-mpmath. Prints the coefficients,
highest power first, and the largest relative error of the rounded fit.
"""
from mpmath import mp, mpf, asin, sqrt, chebyfit, polyval

mp.dps = 60
DEGREE = 12


def remainder(z):
    if z < mpf("1e-18"):
        return mpf(1) / 6 + 3 * z / 40
    s = sqrt(z)
    return (asin(s) - s) / (s * z)


coefficients = [float(c) for c in chebyfit(remainder, [0, mpf(1) / 4], DEGREE + 1)]
for c in coefficients:
    print(repr(c))
worst = max(
    abs((s + s**3 * polyval([mpf(c) for c in coefficients], s**2)) / asin(s) - 1)
    for s in (mpf(k) / 2000 for k in range(1, 1001))
)
print("largest relative error", mp.nstr(worst, 3))
