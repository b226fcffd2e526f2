// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace thalweg::test {

inline std::uint32_t crc32_of(const std::string& bytes) {
    std::uint32_t crc = 0xFFFFFFFF;
    for (const unsigned char byte : bytes) {
        crc ^= byte;
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xEDB88320 : 0);
    }
    return ~crc;
}

inline std::string little_endian(std::uint32_t value, int bytes) {
    std::string out;
    for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * i) & 0xFF);
    return out;
}

/// A zip archive of uncompressed members (name, content), as PKWARE's APPNOTE 4.3 lays it out.
inline std::string zip_of(const std::vector<std::pair<std::string, std::string>>& members) {
    std::string body, directory;
    for (const auto& [name, content] : members) {
        const auto size = static_cast<std::uint32_t>(content.size());
        const std::string common = little_endian(20, 2) + little_endian(0, 4) + little_endian(0, 4) +
                                   little_endian(crc32_of(content), 4) + little_endian(size, 4) +
                                   little_endian(size, 4) + little_endian(static_cast<std::uint32_t>(name.size()), 2) +
                                   little_endian(0, 2);
        directory += little_endian(0x02014B50, 4) + little_endian(20, 2) + common + little_endian(0, 4) +
                     little_endian(0, 4) + little_endian(0, 2) +
                     little_endian(static_cast<std::uint32_t>(body.size()), 4) + name;
        body += little_endian(0x04034B50, 4) + common + name + content;
    }
    const auto count = static_cast<std::uint32_t>(members.size());
    return body + directory + little_endian(0x06054B50, 4) + little_endian(0, 4) + little_endian(count, 2) +
           little_endian(count, 2) + little_endian(static_cast<std::uint32_t>(directory.size()), 4) +
           little_endian(static_cast<std::uint32_t>(body.size()), 4) + little_endian(0, 2);
}

}  // namespace thalweg::test
