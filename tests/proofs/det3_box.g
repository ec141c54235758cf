# SPDX-License-Identifier: MIT
# det3.clh, the float level where no coordinate exceeds 1, by another prover than det3_float.v: within 3 2^-18 of the
# determinant (docs/numerics.md, 7, has 8 u Q there, Q <= 48: twice as much). Assumed: denormals are kept.
@rnd = float<ieee_32,ne>;
u1_x = rnd(u1_x_); u1_y = rnd(u1_y_); u1_z = rnd(u1_z_); u0_x = rnd(u0_x_); u0_y = rnd(u0_y_); u0_z = rnd(u0_z_);
v1_x = rnd(v1_x_); v1_y = rnd(v1_y_); v1_z = rnd(v1_z_); v0_x = rnd(v0_x_); v0_y = rnd(v0_y_); v0_z = rnd(v0_z_);
w1_x = rnd(w1_x_); w1_y = rnd(w1_y_); w1_z = rnd(w1_z_); w0_x = rnd(w0_x_); w0_y = rnd(w0_y_); w0_z = rnd(w0_z_);

# begin: from the kernels, by expressions.py
t0 rnd= w1_x - w0_x;
t1 rnd= u1_y - u0_y;
t2 rnd= v1_z - v0_z;
t3 rnd= t1 * t2;
t4 rnd= u1_z - u0_z;
t5 rnd= v1_y - v0_y;
t6 rnd= t4 * t5;
t7 rnd= t3 - t6;
t8 rnd= t0 * t7;
t9 rnd= w1_y - w0_y;
t10 rnd= v1_x - v0_x;
t11 rnd= t4 * t10;
t12 rnd= u1_x - u0_x;
t13 rnd= t12 * t2;
t14 rnd= t11 - t13;
t15 rnd= t9 * t14;
t16 rnd= t8 + t15;
t17 rnd= w1_z - w0_z;
t18 rnd= t12 * t5;
t19 rnd= t1 * t10;
t20 rnd= t18 - t19;
t21 rnd= t17 * t20;
value rnd= t16 + t21;
# end: from the kernels

ux = u1_x - u0_x; uy = u1_y - u0_y; uz = u1_z - u0_z;
vx = v1_x - v0_x; vy = v1_y - v0_y; vz = v1_z - v0_z;
wx = w1_x - w0_x; wy = w1_y - w0_y; wz = w1_z - w0_z;
determinant = wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx);

{ |u1_x| <= 1 /\ |u1_y| <= 1 /\ |u1_z| <= 1 /\ |u0_x| <= 1 /\ |u0_y| <= 1 /\ |u0_z| <= 1 /\
  |v1_x| <= 1 /\ |v1_y| <= 1 /\ |v1_z| <= 1 /\ |v0_x| <= 1 /\ |v0_y| <= 1 /\ |v0_z| <= 1 /\
  |w1_x| <= 1 /\ |w1_y| <= 1 /\ |w1_z| <= 1 /\ |w0_x| <= 1 /\ |w0_y| <= 1 /\ |w0_z| <= 1
  -> |value - determinant| <= 3b-18 }
