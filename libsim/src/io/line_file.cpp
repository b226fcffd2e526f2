// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/line_file.hpp"

#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include <limits>

#include "io/gdal_guard.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

void add_line(const OGRLineString& line, double area_m2, std::vector<DrainageLine>& lines) {
    DrainageLine added{.points = {}, .area_m2 = area_m2};
    for (const OGRPoint& p : line) added.points.push_back({p.getX(), p.getY()});
    if (added.points.size() > 1) lines.push_back(std::move(added));
}

double area_of(const OGRFeature& feature) {
    const int field = feature.GetFieldIndex("area_m2");
    const bool known = field >= 0 && feature.IsFieldSetAndNotNull(field);
    return known ? feature.GetFieldAsDouble(field) : std::numeric_limits<double>::quiet_NaN();
}

void add_feature(const OGRFeature& feature, std::vector<DrainageLine>& lines) {
    const OGRGeometry* geometry = feature.GetGeometryRef();
    if (geometry == nullptr) return;
    const OGRwkbGeometryType type = wkbFlatten(geometry->getGeometryType());
    if (type == wkbLineString) add_line(*geometry->toLineString(), area_of(feature), lines);
    if (type != wkbMultiLineString) return;
    for (const OGRLineString* part : *geometry->toMultiLineString()) add_line(*part, area_of(feature), lines);
}

}  // namespace

std::vector<DrainageLine> read_drainage_lines(const std::filesystem::path& path) {
    GdalGuard gdal;
    const DatasetPtr file(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
    if (!file) throw Error(fmt::format("{} cannot be read as a vector file{}", path.string(), because(gdal)));
    OGRLayer* layer = file->GetLayerByName("links");
    if (layer == nullptr) layer = file->GetLayer(0);
    std::vector<DrainageLine> lines;
    if (layer != nullptr) {
        for (const auto& feature : *layer) add_feature(*feature, lines);
    }
    if (gdal.failed()) throw Error(fmt::format("{} cannot be read to its end{}", path.string(), because(gdal)));
    if (lines.empty()) throw Error(fmt::format("{} holds no lines in its first layer or in 'links'", path.string()));
    return lines;
}

}  // namespace thalweg::io
