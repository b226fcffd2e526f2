// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace thalweg::study {

struct Digest;  // a running SHA-256

/// A binary file that ends with the SHA-256 of all before, written under another name and put in place whole and
/// flushed to the disk. Numbers stand as this machine holds them (IEEE 754, little endian on every machine thalweg
/// builds for).
class SealedWriter {
  public:
    explicit SealedWriter(std::filesystem::path final);
    ~SealedWriter();
    SealedWriter(const SealedWriter&) = delete;
    SealedWriter& operator=(const SealedWriter&) = delete;

    void bytes(const void* data, std::size_t size);

    /// Throws Error when the disk is full.
    void commit();

  private:
    std::filesystem::path final_, partial_;
    std::ofstream file_;
    std::unique_ptr<Digest> digest_;
};

/// Reads it back. Throws Error when the seal does not fit, before anything is handed out.
class SealedReader {
  public:
    explicit SealedReader(const std::filesystem::path&);
    void bytes(void* data, std::size_t size);
    std::uint64_t left() const { return left_; }
    const std::string& name() const { return name_; }

  private:
    std::string name_;
    std::ifstream file_;
    std::uint64_t left_ = 0;
};

}  // namespace thalweg::study
