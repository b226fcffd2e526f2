// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/render/picture.hpp"

#include <algorithm>
#include <cmath>

namespace thalweg::render {
namespace {

double decoded(std::uint32_t code, int shift) {
    const double c = (code >> shift & 0xff) / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

std::uint8_t encoded(double light) {
    const double c = std::clamp(light, 0.0, 1.0);
    const double code = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255 * code));
}

}  // namespace

Rgb from_srgb(std::uint32_t code) {
    return {static_cast<float>(decoded(code, 16)), static_cast<float>(decoded(code, 8)),
            static_cast<float>(decoded(code, 0))};
}

std::vector<std::uint8_t> to_srgb(const Picture& picture, const Background& background) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * picture.light.size());
    for (Index row = 0; row < picture.height; ++row) {
        const float down = (static_cast<float>(row) + 0.5f) / static_cast<float>(picture.height);
        const Rgb behind = mix(background.upper, background.lower, down);
        for (Index col = 0; col < picture.width; ++col) {
            const std::size_t pixel = std::size_t{row} * picture.width + col;
            const Rgb light = picture.light[pixel] + (1 - picture.coverage[pixel]) * behind;
            for (const float channel : {light.r, light.g, light.b}) bytes.push_back(encoded(channel));
        }
    }
    return bytes;
}

}  // namespace thalweg::render
