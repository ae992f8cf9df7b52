// Elementary functions with the same bits on every CPU, compiler and C library: built from + - * /
// sqrt and integer operations alone. The C library's own differ in the last place between CPUs with
// and without FMA.
#pragma once

namespace rt::numeric {

// Every function is within 1 ulp of the exact value for every argument (elementary.cpp derives it,
// tests/numeric measures it against binary128), is exact where C Annex F prescribes a value, and
// returns a quiet NaN for a NaN.

double exp(double x);
double log(double x);
double pow(double x, double y);

double sin(double radians); // any finite argument; NaN for an infinity
double cos(double radians);
double tan(double radians);

double asin(double x);            // in [-pi/2, pi/2]; NaN outside [-1, 1]
double acos(double x);            // in [0, pi]
double atan2(double y, double x); // in [-pi, pi]

} // namespace rt::numeric
