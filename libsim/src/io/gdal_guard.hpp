// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gdal_priv.h>

#include <memory>
#include <string>
#include <vector>

namespace thalweg::io {

/// While it lives, GDAL's messages of this thread are collected here instead of being printed. The first one made
/// registers the drivers and bounds the block cache.
class GdalGuard {
  public:
    GdalGuard();
    ~GdalGuard();
    GdalGuard(const GdalGuard&) = delete;
    GdalGuard& operator=(const GdalGuard&) = delete;

    bool failed() const { return !failures_.empty(); }
    /// The first failure on one line, without a final stop; "" if there was none.
    std::string reason() const { return failures_.empty() ? "" : failures_.front(); }
    const std::vector<std::string>& warnings() const { return warnings_; }
    void forget();

  private:
    static void collect(CPLErr level, CPLErrorNum, const char* message);
    std::vector<std::string> failures_;
    std::vector<std::string> warnings_;
};

using DatasetPtr = std::unique_ptr<GDALDataset, GDALDatasetUniquePtrDeleter>;

/// ": why", where GDAL said why.
std::string because(const GdalGuard&);

}  // namespace thalweg::io
