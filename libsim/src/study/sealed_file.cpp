// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/sealed_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "thalweg/core/error.hpp"

namespace thalweg::study {
namespace fs = std::filesystem;

struct Digest {
    std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
    Digest() { EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr); }
    void add(const void* data, std::size_t size) { EVP_DigestUpdate(context.get(), data, size); }
    std::array<unsigned char, 32> value() {
        std::array<unsigned char, 32> value{};
        EVP_DigestFinal_ex(context.get(), value.data(), nullptr);
        return value;
    }
};

namespace {

/// Makes sure that what was written survives a loss of power.
bool flush_to_disk(const fs::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY);
    if (file < 0) return false;
    const bool flushed = ::fsync(file) == 0;
    ::close(file);
    return flushed;
}

}  // namespace

SealedWriter::SealedWriter(fs::path final)
    : final_(std::move(final)),
      partial_(final_.string() + ".new"),
      file_(partial_, std::ios::binary),
      digest_(std::make_unique<Digest>()) {}

SealedWriter::~SealedWriter() {
    std::error_code ignored;
    fs::remove(partial_, ignored);
}

void SealedWriter::bytes(const void* data, std::size_t size) {
    digest_->add(data, size);
    file_.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

void SealedWriter::commit() {
    const auto seal = digest_->value();
    file_.write(reinterpret_cast<const char*>(seal.data()), seal.size());
    file_.close();
    std::error_code problem;
    const bool written = file_ && flush_to_disk(partial_);
    if (written) fs::rename(partial_, final_, problem);
    if (!written || problem) {
        throw Error(fmt::format("cannot write '{}': is the disk full?", final_.string()));
    }
    flush_to_disk(final_.parent_path());
}

SealedReader::SealedReader(const fs::path& path) : name_(path.string()), file_(path, std::ios::binary) {
    std::array<unsigned char, 32> seal{};
    std::error_code problem;
    const std::uintmax_t size = fs::file_size(path, problem);
    const auto damaged = [&] {
        return Error(
            fmt::format("'{}' is damaged, so the run cannot go on from it: remove its folder and start anew "
                        "without --resume",
                        name_));
    };
    if (problem || !file_ || size < seal.size()) throw damaged();
    Digest digest;
    std::vector<char> block(1 << 20);
    for (std::uint64_t rest = size - seal.size(); rest > 0;) {
        const auto piece = static_cast<std::streamsize>(std::min<std::uint64_t>(rest, block.size()));
        if (!file_.read(block.data(), piece)) throw damaged();
        digest.add(block.data(), static_cast<std::size_t>(piece));
        rest -= static_cast<std::uint64_t>(piece);
    }
    file_.read(reinterpret_cast<char*>(seal.data()), seal.size());
    if (!file_ || seal != digest.value()) throw damaged();
    left_ = size - seal.size();
    file_.seekg(0);
}

void SealedReader::bytes(void* data, std::size_t size) {
    if (size > left_ || !file_.read(static_cast<char*>(data), static_cast<std::streamsize>(size))) {
        throw Error(fmt::format("'{}' ends too early, so the run cannot go on from it", name_));
    }
    left_ -= size;
}

}  // namespace thalweg::study
