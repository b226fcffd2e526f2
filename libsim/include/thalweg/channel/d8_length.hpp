// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace thalweg::channel {

/// How much longer than the straight line a path in eight directions is, as the mean over all directions of that line:
/// within 45° of an axis it takes cos θ − sin θ along it and √2·sin θ along the diagonal, whose mean is 8(√2 − 1)/π.
constexpr double d8_length_factor = 1.055;

}  // namespace thalweg::channel
