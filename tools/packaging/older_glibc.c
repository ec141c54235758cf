// SPDX-License-Identifier: MIT
// Linked into the wheels of x86-64 with --wrap=hypot --wrap=hypotf: glibc 2.35 gave both functions a new version, and
// they are all that a wheel needs beyond 2.34. Their older version computes the same, and sets errno besides.
double older_hypot(double, double);
float older_hypotf(float, float);
__asm__(".symver older_hypot, hypot@GLIBC_2.2.5");
__asm__(".symver older_hypotf, hypotf@GLIBC_2.2.5");

__attribute__((visibility("hidden"))) double __wrap_hypot(double x, double y) { return older_hypot(x, y); }
__attribute__((visibility("hidden"))) float __wrap_hypotf(float x, float y) { return older_hypotf(x, y); }
