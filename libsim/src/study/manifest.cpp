// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/study/manifest.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <tbb/version.h>
#include <Eigen/Core>

#include <array>
#include <fstream>
#include <memory>

#include "study/build_info.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/infer/versions.hpp"
#include "thalweg/io/versions.hpp"
#include "thalweg/mesh/versions.hpp"
#include "thalweg/render/versions.hpp"

namespace thalweg::study {

std::string sha256_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
    EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr);
    std::vector<char> block(1 << 20);
    while (file) {
        file.read(block.data(), static_cast<std::streamsize>(block.size()));
        EVP_DigestUpdate(context.get(), block.data(), static_cast<std::size_t>(file.gcount()));
    }
    if (!file.eof()) throw Error(fmt::format("cannot read '{}'", path.string()));
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    EVP_DigestFinal_ex(context.get(), digest.data(), &size);
    std::string text;
    for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
}

Versions versions() {
    Versions v{.thalweg = THALWEG_VERSION, .commit = THALWEG_COMMIT, .libraries = {}};
    for (const auto& libraries : {io::library_versions(), mesh::library_versions(), infer::library_versions(),
                                  render::library_versions()}) {
        v.libraries.insert(v.libraries.end(), libraries.begin(), libraries.end());
    }
    v.libraries.emplace_back("oneTBB", fmt::format("{}.{}", TBB_VERSION_MAJOR, TBB_VERSION_MINOR));
    v.libraries.emplace_back("Eigen",
                             fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION));
    return v;
}

}  // namespace thalweg::study
