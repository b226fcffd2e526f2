// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gdal_guard.hpp"

#include <cpl_error.h>

#include <algorithm>
#include <mutex>

namespace thalweg::io {
namespace {

std::once_flag registered;

void register_drivers() {
    GDALAllRegister();
    // Rasters are streamed once; a large cache (GDAL's default is 5 % of the memory) would only hold dead blocks.
    GDALSetCacheMax64(GIntBig{16} << 20);
}

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
    return text;
}

}  // namespace

GdalGuard::GdalGuard() {
    CPLPushErrorHandlerEx(collect, this);
    std::call_once(registered, register_drivers);
    forget();  // what a driver says while it is registered concerns no file of ours
}

GdalGuard::~GdalGuard() { CPLPopErrorHandler(); }

void GdalGuard::collect(CPLErr level, CPLErrorNum, const char* message) {
    auto* guard = static_cast<GdalGuard*>(CPLGetErrorHandlerUserData());
    if (level == CE_Failure || level == CE_Fatal) guard->failures_.push_back(one_line(message));
    if (level == CE_Warning) guard->warnings_.push_back(one_line(message));
}

void GdalGuard::forget() {
    failures_.clear();
    warnings_.clear();
}

std::string because(const GdalGuard& gdal) { return gdal.failed() ? ": " + gdal.reason() : ""; }

}  // namespace thalweg::io
