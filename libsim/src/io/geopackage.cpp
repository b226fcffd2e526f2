// SPDX-License-Identifier: GPL-3.0-or-later
#include <cpl_conv.h>
#include <cpl_string.h>
#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "io/gdal_guard.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/table_file.hpp"

namespace thalweg::io {
namespace {

/// GeoPackages carry the date of their last change; a fixed one makes equal contents equal bytes.
class FixedDate {
  public:
    FixedDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "2000-01-01T00:00:00Z"); }
    ~FixedDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr); }
    FixedDate(const FixedDate&) = delete;
    FixedDate& operator=(const FixedDate&) = delete;
};

OGRSpatialReference crs_of(const std::string& wkt) {
    OGRSpatialReference crs;
    const std::string text = !wkt.empty() ? wkt
                                          : R"(ENGCRS["Undefined Cartesian SRS",EDATUM[""],CS[Cartesian,2],)"
                                            R"(AXIS["x",east],AXIS["y",north],LENGTHUNIT["metre",1]])";
    if (crs.importFromWkt(text.c_str()) != OGRERR_NONE) {
        throw Error("the coordinate system to be written cannot be understood");
    }
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return crs;
}

OGRwkbGeometryType wkb_type(GeometryKind kind) {
    switch (kind) {
        case GeometryKind::point:
            return wkbPoint;
        case GeometryKind::line:
            return wkbLineString;
        case GeometryKind::polygon:
            return wkbMultiPolygon;
        case GeometryKind::no_geometry:
            break;
    }
    return wkbNone;
}

void add_points(OGRSimpleCurve& curve, const std::vector<Point>& points) {
    curve.setNumPoints(static_cast<int>(points.size()), FALSE);
    for (int i = 0; const Point& p : points) curve.setPoint(i++, p.x, p.y);
}

std::unique_ptr<OGRGeometry> make_geometry(GeometryKind kind, const std::vector<Point>& points) {
    if (points.empty()) return nullptr;
    if (kind == GeometryKind::point) return std::make_unique<OGRPoint>(points[0].x, points[0].y);
    auto line = std::make_unique<OGRLineString>();
    add_points(*line, points);
    return line;
}

void add_ring(OGRPolygon& polygon, const Polygon& points) {
    auto ring = std::make_unique<OGRLinearRing>();
    add_points(*ring, points);
    ring->closeRings();
    polygon.addRingDirectly(ring.release());
}

std::unique_ptr<OGRGeometry> make_geometry(const MultiPolygon& parts) {
    if (parts.empty()) return nullptr;
    auto surface = std::make_unique<OGRMultiPolygon>();
    for (const PolygonPart& part : parts) {
        auto polygon = std::make_unique<OGRPolygon>();
        add_ring(*polygon, part.outer);
        for (const Polygon& hole : part.holes) add_ring(*polygon, hole);
        surface->addGeometryDirectly(polygon.release());
    }
    return surface;
}

std::unique_ptr<OGRGeometry> geometry_of(const Table& table, std::size_t row) {
    if (table.kind == GeometryKind::no_geometry) return nullptr;
    if (table.kind == GeometryKind::polygon) return make_geometry(table.polygons[row]);
    return make_geometry(table.kind, table.geometry[row]);
}

OGRFieldType field_type(const Column& column) {
    if (std::holds_alternative<std::vector<double>>(column.values)) return OFTReal;
    return std::holds_alternative<std::vector<std::int64_t>>(column.values) ? OFTInteger64 : OFTString;
}

void set_field(OGRFeature& feature, int field, double value) {
    if (std::isnan(value))
        feature.SetFieldNull(field);
    else
        feature.SetField(field, value);
}
void set_field(OGRFeature& feature, int field, std::int64_t value) {
    feature.SetField(field, static_cast<GIntBig>(value));
}
void set_field(OGRFeature& feature, int field, const std::string& value) { feature.SetField(field, value.c_str()); }

/// A name for GDAL's own column that no column of the table has.
std::string free_name(const Table& table, std::string name) {
    const auto taken = [&](const Column& column) { return EQUAL(column.name.c_str(), name.c_str()); };
    while (std::any_of(table.columns.begin(), table.columns.end(), taken)) name += '_';
    return name;
}

std::string geometry_column(const Table& table) { return free_name(table, "geom"); }

class PackageWriter {
  public:
    PackageWriter(const std::filesystem::path& path, const GdalGuard& gdal) : path_(path), gdal_(gdal) {
        GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
        dataset_.reset(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
        if (!dataset_) throw Error(fmt::format("{} cannot be created{}", path.string(), because(gdal)));
    }

    void write(const Table& table, OGRSpatialReference& crs) {
        const std::size_t rows = row_count(table);
        OGRLayer& layer = create_layer(table, crs);
        for (std::size_t row = 0; row < rows; ++row) write_row(layer, table, row);
    }

    /// The table that QGIS makes when it saves styles in a GeoPackage, with the same columns.
    void write_styles(const std::vector<Table>& tables) {
        const auto has_style = [](const Table& table) { return !table.style.empty(); };
        if (std::none_of(tables.begin(), tables.end(), has_style)) return;
        CPLStringList options;
        options.SetNameValue("FID", "id");
        OGRLayer* layer = dataset_->CreateLayer("layer_styles", nullptr, wkbNone, options.List());
        check(layer == nullptr ? OGRERR_FAILURE : OGRERR_NONE);
        for (const char* name : {"f_table_catalog", "f_table_schema", "f_table_name", "f_geometry_column", "styleName",
                                 "styleQML", "styleSLD"}) {
            add_field(*layer, name, OFTString);
        }
        add_field(*layer, "useAsDefault", OFTInteger, OFSTBoolean);
        for (const char* name : {"description", "owner", "ui"}) add_field(*layer, name, OFTString);
        add_field(*layer, "update_time", OFTDateTime);
        for (const Table& table : tables) {
            if (has_style(table)) write_style(*layer, table);
        }
    }

    void begin() { check(dataset_->StartTransaction()); }
    void end() {
        check(dataset_->CommitTransaction());
        dataset_.reset();
        check(OGRERR_NONE);
    }

  private:
    void check(OGRErr status) const {
        if (status == OGRERR_NONE && !gdal_.failed()) return;
        throw Error(fmt::format("{} could not be written whole{}", path_.string(), because(gdal_)));
    }

    OGRLayer& create_layer(const Table& table, OGRSpatialReference& crs) {
        CPLStringList options;
        options.SetNameValue("FID", free_name(table, "fid").c_str());
        options.SetNameValue("GEOMETRY_NAME", geometry_column(table).c_str());
        if (row_count(table) > most_indexed_rows) options.SetNameValue("SPATIAL_INDEX", "NO");
        const OGRwkbGeometryType type = wkb_type(table.kind);
        OGRLayer* layer =
            dataset_->CreateLayer(table.name.c_str(), type == wkbNone ? nullptr : &crs, type, options.List());
        check(layer == nullptr ? OGRERR_FAILURE : OGRERR_NONE);
        for (const Column& column : table.columns) {
            const OGRFieldDefn field(column.name.c_str(), field_type(column));
            check(layer->CreateField(const_cast<OGRFieldDefn*>(&field), FALSE));
        }
        return *layer;
    }

    void add_field(OGRLayer& layer, const char* name, OGRFieldType type, OGRFieldSubType subtype = OFSTNone) {
        OGRFieldDefn field(name, type);
        field.SetSubType(subtype);
        check(layer.CreateField(&field, FALSE));
    }

    void write_style(OGRLayer& layer, const Table& table) {
        OGRFeature feature(layer.GetLayerDefn());
        for (const char* empty : {"f_table_catalog", "f_table_schema", "styleSLD", "owner"})
            feature.SetField(empty, "");
        feature.SetField("f_table_name", table.name.c_str());
        feature.SetField("f_geometry_column",
                         table.kind == GeometryKind::no_geometry ? "" : geometry_column(table).c_str());
        feature.SetField("styleName", table.name.c_str());
        feature.SetField("styleQML", table.style.c_str());
        feature.SetField("useAsDefault", 1);
        feature.SetField("description", "written by thalweg");
        feature.SetField("update_time", 2000, 1, 1);
        check(layer.CreateFeature(&feature));
    }

    void write_row(OGRLayer& layer, const Table& table, std::size_t row) {
        OGRFeature feature(layer.GetLayerDefn());
        for (int field = 0; const Column& column : table.columns) {
            std::visit([&](const auto& values) { set_field(feature, field, values[row]); }, column.values);
            ++field;
        }
        if (auto geometry = geometry_of(table, row)) feature.SetGeometryDirectly(geometry.release());
        check(layer.CreateFeature(&feature));
    }

    const std::filesystem::path& path_;
    const GdalGuard& gdal_;
    DatasetPtr dataset_;
};

void remove_package(const std::filesystem::path& path) {
    std::error_code ignored;
    for (const char* suffix : {"", "-journal", "-wal", "-shm"}) {
        const std::filesystem::path part = path.string() + suffix;
        if (std::filesystem::is_regular_file(part, ignored)) std::filesystem::remove(part, ignored);
    }
}

}  // namespace

void write_geopackage(const std::filesystem::path& path, const std::vector<Table>& layers, const std::string& crs_wkt) {
    const GdalGuard gdal;
    const FixedDate date;
    remove_package(path);
    try {
        OGRSpatialReference crs = crs_of(crs_wkt);
        PackageWriter writer(path, gdal);
        writer.begin();
        for (const Table& table : layers) writer.write(table, crs);
        writer.write_styles(layers);
        writer.end();
    } catch (const Error&) {
        remove_package(path);
        throw;
    }
}

}  // namespace thalweg::io
