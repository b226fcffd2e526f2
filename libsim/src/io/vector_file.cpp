// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/vector_file.hpp"

#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "io/crs_text.hpp"
#include "io/gdal_guard.hpp"
#include "thalweg/core/error.hpp"

namespace thalweg::io {
namespace {

using TransformationPtr = std::unique_ptr<OGRCoordinateTransformation>;

/// Longitude first, whatever the system's own order.
OGRSpatialReference east_first(const OGRSpatialReference& crs) {
    OGRSpatialReference copy(crs);
    copy.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return copy;
}

OGRSpatialReference wanted_crs(const std::string& wkt) {
    OGRSpatialReference crs;
    if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE) {
        throw Error("the coordinate system of the terrain cannot be understood");
    }
    return east_first(crs);
}

class Reader {
  public:
    Reader(const std::filesystem::path& path, const VectorOptions& options) : path_(path), options_(options) {
        if (!options.crs_wkt.empty()) set_system(wanted_crs(options.crs_wkt));
    }

    VectorShapes read(GDALDataset& dataset) {
        for (OGRLayer* layer : chosen(dataset)) read_layer(*layer);
        return std::move(shapes_);
    }

  private:
    std::vector<OGRLayer*> chosen(GDALDataset& dataset) const {
        for (const std::string& name : options_.layers) {
            if (OGRLayer* layer = dataset.GetLayerByName(name.c_str())) return {layer};
        }
        std::vector<OGRLayer*> all;
        for (int i = 0; i < dataset.GetLayerCount(); ++i) all.push_back(dataset.GetLayer(i));
        return all;
    }

    void set_system(const OGRSpatialReference& crs) {
        target_ = std::make_unique<OGRSpatialReference>(crs);
        shapes_.crs_wkt = wkt_of(crs);
        shapes_.geographic = crs.IsGeographic();
        shapes_.unit_m = crs.IsGeographic() ? 1 : crs.GetLinearUnits();
    }

    /// Nothing where the layer's coordinates can be taken as they are.
    TransformationPtr transformation_of(OGRLayer& layer) {
        const OGRSpatialReference* own = layer.GetSpatialRef();
        if (own == nullptr || own->IsLocal()) return nullptr;
        const OGRSpatialReference source = east_first(*own);
        if (!target_) set_system(source);
        if (source.IsSame(target_.get())) return nullptr;
        if (options_.crs_wkt.empty()) {
            throw Error(fmt::format("the layers of {} lie in different coordinate systems: extract the one to be read",
                                    path_.string()));
        }
        TransformationPtr transformation(OGRCreateCoordinateTransformation(&source, target_.get()));
        if (!transformation) {
            throw Error(fmt::format("there is no way from the coordinate system of {} ({}) to the terrain's",
                                    path_.string(), source.GetName()));
        }
        return transformation;
    }

    void read_layer(OGRLayer& layer) {
        const TransformationPtr transformation = transformation_of(layer);
        layer.ResetReading();
        for (const auto& feature : layer) {
            const OGRGeometry* geometry = feature->GetGeometryRef();
            if (geometry == nullptr || geometry->IsEmpty()) continue;
            std::unique_ptr<OGRGeometry> copy(geometry->getLinearGeometry());
            if (transformation && copy->transform(transformation.get()) != OGRERR_NONE) {
                throw Error(
                    fmt::format("a shape of {} has no place in the terrain's coordinate system", path_.string()));
            }
            add(*copy);
        }
    }

    void add(const OGRGeometry& geometry) {
        switch (wkbFlatten(geometry.getGeometryType())) {
            case wkbPoint:
                shapes_.points.push_back(place(*geometry.toPoint()));
                break;
            case wkbLineString:
                shapes_.lines.push_back(places(*geometry.toLineString()));
                break;
            case wkbPolygon:
                shapes_.polygons.push_back(part(*geometry.toPolygon()));
                break;
            default:
                add_members(geometry);
        }
    }

    /// Of a collection, however deep; kept in a list, for a file may nest them as it likes.
    void add_members(const OGRGeometry& geometry) {
        std::vector<const OGRGeometry*> waiting{&geometry};
        while (!waiting.empty()) {
            const OGRGeometry* next = waiting.back();
            waiting.pop_back();
            const OGRwkbGeometryType type = wkbFlatten(next->getGeometryType());
            if (type == wkbPoint || type == wkbLineString || type == wkbPolygon) add(*next);
            if (!OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) continue;
            const OGRGeometryCollection& members = *next->toGeometryCollection();
            for (int i = members.getNumGeometries(); i-- > 0;) waiting.push_back(members.getGeometryRef(i));
        }
    }

    Point place(const OGRPoint& p) const {
        if (!std::isfinite(p.getX()) || !std::isfinite(p.getY())) {
            throw Error(fmt::format("a shape of {} has a vertex at ({}, {})", path_.string(), p.getX(), p.getY()));
        }
        return {p.getX(), p.getY()};
    }

    std::vector<Point> places(const OGRLineString& line) const {
        std::vector<Point> result;
        for (const OGRPoint& p : line) result.push_back(place(p));
        return result;
    }

    Polygon ring(const OGRLinearRing& line, bool clockwise) const {
        Polygon result = places(line);
        if (result.size() > 1 && result.front() == result.back()) result.pop_back();
        if (static_cast<bool>(line.isClockwise()) != clockwise) std::reverse(result.begin(), result.end());
        return result;
    }

    PolygonPart part(const OGRPolygon& polygon) const {
        PolygonPart result{ring(*polygon.getExteriorRing(), false), {}};
        for (int i = 0; i < polygon.getNumInteriorRings(); ++i) {
            result.holes.push_back(ring(*polygon.getInteriorRing(i), true));
        }
        return result;
    }

    const std::filesystem::path& path_;
    const VectorOptions& options_;
    std::unique_ptr<OGRSpatialReference> target_;
    VectorShapes shapes_;
};

}  // namespace

VectorShapes read_vectors(const std::filesystem::path& path, const VectorOptions& options) {
    const GdalGuard gdal;
    std::error_code failure;
    if (!std::filesystem::exists(path, failure)) throw Error(fmt::format("{} does not exist", path.string()));
    const DatasetPtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
    if (!dataset) {
        throw Error(fmt::format("{} is no vector file that GDAL reads (GeoPackage, GeoJSON, Shapefile, …){}",
                                path.string(), because(gdal)));
    }
    VectorShapes shapes = Reader(path, options).read(*dataset);
    if (gdal.failed()) throw Error(fmt::format("{} cannot be read whole{}", path.string(), because(gdal)));
    return shapes;
}

}  // namespace thalweg::io
