// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "thalweg/core/index.hpp"

namespace thalweg::render {

/// Linear light (not gamma-encoded) of the three primaries of sRGB; 1 is a white surface in full light.
struct Rgb {
    float r = 0, g = 0, b = 0;
};

inline Rgb operator+(const Rgb& a, const Rgb& b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
inline Rgb operator*(const Rgb& a, const Rgb& b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
inline Rgb operator*(float s, const Rgb& a) { return {s * a.r, s * a.g, s * a.b}; }
inline Rgb mix(const Rgb& a, const Rgb& b, float share_of_b) { return (1 - share_of_b) * a + share_of_b * b; }

/// The colour of an HTML code such as 0x8a8278.
Rgb from_srgb(std::uint32_t code);

/// Pixels row by row from the upper left.
struct Picture {
    Index width = 0, height = 0;
    std::vector<Rgb> light;       ///< of what is drawn, times its coverage
    std::vector<float> coverage;  ///< share of the pixel that is drawn on, 0–1
};

/// What lies behind the terrain: a colour at the upper and one at the lower edge.
struct Background {
    Rgb upper, lower;
};

/// Red, green, blue of 8 bits (sRGB, IEC 61966-2-1) for every pixel, over the background.
std::vector<std::uint8_t> to_srgb(const Picture&, const Background&);

}  // namespace thalweg::render
