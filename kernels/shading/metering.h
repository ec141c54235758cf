// SPDX-License-Identifier: MIT
// Contract of the metering: which light the given part of a picture's surfaces does not exceed. The order of floats
// from 0 on is that of their bits, of which there are 31: three passes each count one digit's values among the lights
// whose higher digits are those chosen before, and choose the digit that the rank falls into. So the chosen light is
// the one that sorting would find.
#pragma once

#include "prelude.h"

#define METER_PASSES 3
// Digits of 11, 10 and 10 bits.
#define METER_SHIFT(pass) (20 - 10 * (pass))
#define METER_DIGITS 2048

// The rank among n lights, from 0: METER_NUMERATOR / METER_DENOMINATOR (n - 1), rounded down.
#define METER_NUMERATOR 19
#define METER_DENOMINATOR 20

GN_STRUCT_BEGIN(Meter)
    uint count;   // of the surfaces' pixels
    uint rank;    // among those with the chosen digits
    uint chosen;  // the digits, then the light's bits
    uint padding;
GN_STRUCT_END(Meter, 16)
