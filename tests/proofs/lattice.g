# SPDX-License-Identifier: MIT
# rounded_up_at_half() (host/lattice/world_lattice.cpp), for up to 2^46 steps either way: the fraction is exact from half a
# step on, and below that on the positive side, where it is `steps`. From -1/2 to 0 it may round, but is at least 1/2, as it should be: so its
# comparison with 1/2 is always right. Nothing ties this file to the code: it is the host's.
@double = float<ieee_64,ne>;
steps = double(steps_);
below = int<dn>(steps);
fraction double= steps - below;
{ (|steps| in [0.5, 1b46] -> fraction - (steps - below) in [0, 0]) /\
  (steps in [-0.5, 0] -> below in [-1, -1] -> fraction >= 0.5) }
