// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/io/table_file.hpp"

#include <ogrsf_frmts.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>

#include "io/file_limit.hpp"
#include "support/temp_folder.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/core/random.hpp"
#include "thalweg/io/polygonize.hpp"

using namespace thalweg;
using test::bytes_of;
using test::error_of;
using test::TempFolder;

namespace {

const double no_value = std::numeric_limits<double>::quiet_NaN();

Table small_table() {
    return {.name = "sheet",
            .columns = {{"height_m", std::vector<double>{0.1, no_value, -1e-300}},
                        {"count", std::vector<std::int64_t>{1, -9007199254740993, 3}},
                        {"remark, \"quoted\"", std::vector<std::string>{"plain", "a,b", "two\nlines \"here\""}}},
            .kind = GeometryKind::no_geometry,
            .geometry = {}};
}

Table point_table(int rows) {
    Table table{.name = "points", .columns = {}, .kind = GeometryKind::point, .geometry = {}};
    std::vector<double> value;
    for (int i = 0; i < rows; ++i) {
        value.push_back(i / 3.0);
        table.geometry.push_back({{i * 10.0, i * -5.0}});
    }
    table.columns.push_back({"value_m", value});
    return table;
}

std::vector<Table> three_layers() {
    return {point_table(3),
            {.name = "links",
             .columns = {{"fid", std::vector<std::int64_t>{7, 8}}, {"geom", std::vector<std::string>{"a", "b"}}},
             .kind = GeometryKind::line,
             .geometry = {{{0, 0}, {1, 2}, {3, 3}}, {{5, 5}, {6, 7}}}},
            {.name = "basins",
             .columns = {{"area_m2", std::vector<double>{0.5, no_value}}},
             .kind = GeometryKind::polygon,
             .geometry = {},
             .polygons = {{{.outer = {{0, 0}, {1, 0}, {1, 1}}, .holes = {}}},
                          {{.outer = {{0, 0}, {4, 0}, {4, 4}, {0, 4}}, .holes = {{{1, 1}, {1, 2}, {2, 2}, {2, 1}}}},
                           {.outer = {{4, 4}, {6, 4}, {6, 6}, {4, 6}}, .holes = {}}}}}};
}

}  // namespace

TEST_CASE("a CSV is quoted as RFC 4180 says and its numbers are the shortest that read back", "[csv]") {
    const TempFolder folder;
    io::write_csv(folder / "sheet.csv", small_table());
    CHECK(bytes_of(folder / "sheet.csv") ==
          "height_m,count,\"remark, \"\"quoted\"\"\"\n"
          "0.1,1,plain\n"
          ",-9007199254740993,\"a,b\"\n"
          "-1e-300,3,\"two\nlines \"\"here\"\"\"\n");
}

TEST_CASE("doubles survive a CSV to the last bit", "[csv]") {
    const TempFolder folder;
    std::vector<double> values{0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308, -0.0, 123456789.123456789};
    for (int i = 0; i < 2000; ++i) values.push_back(std::sin(i) * std::pow(10, i % 40 - 20));
    Table table{.name = "t", .columns = {{"v", values}}, .kind = GeometryKind::no_geometry, .geometry = {}};
    io::write_csv(folder / "t.csv", table);
    const Table back = io::read_csv(folder / "t.csv");
    CHECK(back.name == "t");
    CHECK(std::get<std::vector<double>>(back.columns.at(0).values) == values);
}

TEST_CASE("columns of a CSV are numbers where all fields are numbers or empty, else text", "[csv]") {
    const TempFolder folder;
    const Table table = io::read_csv(folder.text("t.csv",
                                                 "\xEF\xBB\xBF"
                                                 "a,b,\"c \"\"x\"\"\"\r\n1,,\"p,q\"\r\n2e3,7,\"r\ns\"\r\n"));
    REQUIRE(table.columns.size() == 3);
    CHECK(table.columns[0].name == "a");
    CHECK(std::get<std::vector<double>>(table.columns[0].values) == std::vector<double>{1, 2000});
    CHECK(std::isnan(std::get<std::vector<double>>(table.columns[1].values)[0]));
    CHECK(table.columns[2].name == "c \"x\"");
    CHECK(std::get<std::vector<std::string>>(table.columns[2].values) == std::vector<std::string>{"p,q", "r\ns"});
    const Table text = io::read_csv(folder.text("u.csv", "a\n1\n1 m\n"));
    CHECK(std::get<std::vector<std::string>>(text.columns[0].values) == std::vector<std::string>{"1", "1 m"});
}

TEST_CASE("a broken CSV is refused with the number of the line", "[csv]") {
    const TempFolder folder;
    const auto read = [&](const std::string& text) {
        return error_of([&] { io::read_csv(folder.text("t.csv", text)); });
    };
    CHECK(read("a,b\n1,2\n3\n").find("line 3") != std::string::npos);
    CHECK(read("a,b\n\"x\ny\",2\n3\n").find("line 4") != std::string::npos);
    CHECK(read("a,b\n1,\"2\n").find("line 2") != std::string::npos);
    CHECK(read("a,b\n1,\"2\"x\n").find("line 2") != std::string::npos);
    CHECK(read("").find("header") != std::string::npos);
    CHECK(error_of([&] { io::read_csv(folder / "none.csv"); }).find("No such file") != std::string::npos);
    CHECK(error_of([&] { io::read_csv(folder / ""); }).find("folder") != std::string::npos);
}

TEST_CASE("a CSV that cannot be written whole is an error and leaves nothing", "[csv]") {
    const TempFolder folder;
    CHECK(error_of([&] { io::write_csv(folder / "no/such/t.csv", small_table()); }) != "");
    if (std::filesystem::exists("/dev/full")) {
        CHECK(error_of([&] { io::write_csv("/dev/full", small_table()); }).find("No space") != std::string::npos);
        CHECK(std::filesystem::exists("/dev/full"));
    }
    const test::FileLimit limit(20);
    CHECK(test::is_sentence(error_of([&] { io::write_csv(folder / "t.csv", small_table()); })));
    CHECK(folder.empty());
}

TEST_CASE("a GeoPackage holds its layers, geometries and numbers", "[geopackage]") {
    const TempFolder folder;
    io::write_geopackage(folder / "g.gpkg", three_layers(), "");
    const GDALDatasetUniquePtr package(
        GDALDataset::Open((folder / "g.gpkg").c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr));
    REQUIRE(package);
    REQUIRE(package->GetLayerCount() == 3);
    OGRLayer* points = package->GetLayerByName("points");
    REQUIRE(points->GetFeatureCount() == 3);
    const OGRFeatureUniquePtr second(points->GetFeature(2));
    CHECK(second->GetFieldAsDouble("value_m") == 1 / 3.0);
    CHECK(second->GetGeometryRef()->toPoint()->getY() == -5);
    CHECK(points->GetSpatialRef()->IsGeographic() == 0);
    OGRLayer* links = package->GetLayerByName("links");
    const OGRFeatureUniquePtr link(links->GetNextFeature());
    CHECK(link->GetFieldAsInteger64("fid") == 7);
    CHECK(std::string(link->GetFieldAsString("geom")) == "a");
    CHECK(link->GetGeometryRef()->toLineString()->getNumPoints() == 3);
    OGRLayer* basins = package->GetLayerByName("basins");
    CHECK(basins->GetGeomType() == wkbMultiPolygon);
    const OGRFeatureUniquePtr triangle(basins->GetNextFeature());
    CHECK(triangle->GetGeometryRef()->toMultiPolygon()->get_Area() == 0.5);
    const OGRFeatureUniquePtr square(basins->GetNextFeature());
    const OGRMultiPolygon* parts = square->GetGeometryRef()->toMultiPolygon();
    CHECK(parts->IsValid());
    CHECK(parts->getNumGeometries() == 2);
    CHECK(parts->getGeometryRef(0)->getNumInteriorRings() == 1);
    CHECK(parts->get_Area() == 19);
    CHECK(square->IsFieldNull(0));
}

TEST_CASE("surfaces of cells come back from a GeoPackage with the area of their cells", "[geopackage]") {
    const TempFolder folder;
    Raster frame;
    frame.grid = plane_grid(40, 50, 1, 1);
    frame.placement = {.west = 500000, .north = 4000000, .cell_width = 30, .cell_height = 20, .crs_wkt = {}};
    Random random(5, 1);
    std::vector<Index> labels(frame.grid.size());
    for (Index& label : labels) label = random.below(4) ? 0 : 1 + random.below(3);
    std::vector<double> cells(5, 0);  // the last label has none
    for (const Index label : labels) ++cells[label];
    const Table basins{.name = "basins",
                       .columns = {{"cells", cells}},
                       .kind = GeometryKind::polygon,
                       .geometry = {},
                       .polygons = io::cell_outlines(frame, labels, 5)};
    io::write_geopackage(folder / "g.gpkg", {basins}, "");
    const GDALDatasetUniquePtr package(
        GDALDataset::Open((folder / "g.gpkg").c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr));
    REQUIRE(package);
    for (const double count : cells) {
        const OGRFeatureUniquePtr feature(package->GetLayer(0)->GetNextFeature());
        CHECK(feature->GetFieldAsDouble("cells") == count);
        const OGRGeometry* shape = feature->GetGeometryRef();
        CHECK((shape == nullptr) == (count == 0));
        if (shape == nullptr) continue;
        CHECK(shape->IsValid());
        CHECK(shape->toMultiPolygon()->get_Area() == count * 600);
    }
}

TEST_CASE("a table whose geometry is not of its kind or number is refused", "[geopackage]") {
    Table table{.name = "t", .columns = {{"v", std::vector<double>{1}}}, .geometry = {}};
    CHECK(row_count(table) == 1);
    table.geometry = {{{0, 0}}};
    CHECK(error_of([&] { row_count(table); }).find("another kind") != std::string::npos);
    table.kind = GeometryKind::point;
    CHECK(row_count(table) == 1);
    table.polygons.resize(1);
    CHECK(error_of([&] { row_count(table); }).find("another kind") != std::string::npos);
    table.kind = GeometryKind::polygon;
    CHECK(error_of([&] { row_count(table); }).find("another kind") != std::string::npos);
    table.geometry.clear();
    CHECK(row_count(table) == 1);
    table.polygons.resize(2);
    CHECK(test::is_sentence(error_of([&] { row_count(table); })));
}

TEST_CASE("a GeoPackage carries the coordinate system it was given", "[geopackage]") {
    const TempFolder folder;
    OGRSpatialReference utm;
    utm.importFromEPSG(32611);
    char* wkt = nullptr;
    utm.exportToWkt(&wkt);
    io::write_geopackage(folder / "g.gpkg", {point_table(2)}, wkt);
    CPLFree(wkt);
    const GDALDatasetUniquePtr package(
        GDALDataset::Open((folder / "g.gpkg").c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr));
    REQUIRE(package);
    CHECK(std::string(package->GetLayer(0)->GetSpatialRef()->GetAuthorityCode(nullptr)) == "32611");
    CHECK(error_of([&] { io::write_geopackage(folder / "h.gpkg", {point_table(2)}, "nonsense"); }) != "");
    CHECK_FALSE(std::filesystem::exists(folder / "h.gpkg"));
}

TEST_CASE("the same tables give the same GeoPackage, byte for byte, also over an older one", "[geopackage]") {
    const TempFolder folder;
    io::write_geopackage(folder / "a.gpkg", three_layers(), "");
    ::usleep(1100000);  // a clock that were asked would have moved on by a second
    io::write_geopackage(folder / "b.gpkg", {point_table(500)}, "");
    io::write_geopackage(folder / "b.gpkg", three_layers(), "");
    CHECK(bytes_of(folder / "a.gpkg") == bytes_of(folder / "b.gpkg"));
}

TEST_CASE("a GeoPackage that cannot be written whole is an error and leaves nothing", "[geopackage]") {
    const TempFolder folder;
    CHECK(error_of([&] { io::write_geopackage(folder / "no/such/g.gpkg", three_layers(), ""); }) != "");
    for (const std::size_t bytes : {100, 20000, 100000, 150000}) {
        const test::FileLimit limit(bytes);
        CHECK(test::is_sentence(error_of([&] { io::write_geopackage(folder / "g.gpkg", {point_table(3000)}, ""); })));
        CHECK(folder.empty());
    }
}

TEST_CASE("Layers have a spatial index up to the size where it would take most of the time", "[geopackage]") {
    const TempFolder folder;
    GDALAllRegister();
    const auto is_indexed = [&](std::size_t rows) {
        Table table{.name = "points", .columns = {}, .kind = GeometryKind::point, .geometry = {}};
        table.geometry.assign(rows, {{1, 2}});
        io::write_geopackage(folder / "points.gpkg", {table}, "");
        const GDALDatasetUniquePtr file(GDALDataset::Open((folder / "points.gpkg").c_str(), GDAL_OF_VECTOR));
        REQUIRE(file->GetLayerByName("points")->GetFeatureCount() == static_cast<GIntBig>(rows));
        OGRLayer* answer = file->ExecuteSQL("SELECT HasSpatialIndex('points', 'geom')", nullptr, nullptr);
        REQUIRE(answer != nullptr);
        const OGRFeatureUniquePtr row(answer->GetNextFeature());
        const bool indexed = row->GetFieldAsInteger(0) == 1;
        file->ReleaseResultSet(answer);
        return indexed;
    };
    CHECK(is_indexed(3));
    CHECK_FALSE(is_indexed(io::most_indexed_rows + 1));
}

TEST_CASE("Styles stand where QGIS looks for them, each the default of its layer") {
    const TempFolder temp;
    std::vector<Table> layers = three_layers();
    layers[0].style = "<qgis/>";
    layers[1].style = "<qgis version=\"3.22\"/>";
    io::write_geopackage(temp / "a.gpkg", layers, "");
    io::write_geopackage(temp / "b.gpkg", layers, "");
    CHECK(bytes_of(temp / "a.gpkg") == bytes_of(temp / "b.gpkg"));
    GDALAllRegister();
    auto* data = GDALDataset::Open((temp / "a.gpkg").c_str(), GDAL_OF_VECTOR);
    REQUIRE(data != nullptr);
    CHECK(data->GetLayerCount() == 4);
    OGRLayer* styles = data->GetLayerByName("layer_styles");
    REQUIRE(styles != nullptr);
    CHECK(std::string(styles->GetFIDColumn()) == "id");
    const OGRFeatureDefn& columns = *styles->GetLayerDefn();
    const std::vector<std::string> names{"f_table_catalog", "f_table_schema", "f_table_name", "f_geometry_column",
                                         "styleName",       "styleQML",       "styleSLD",     "useAsDefault",
                                         "description",     "owner",          "ui",           "update_time"};
    REQUIRE(columns.GetFieldCount() == static_cast<int>(names.size()));
    for (std::size_t i = 0; i < names.size(); ++i) {
        CHECK(columns.GetFieldDefn(static_cast<int>(i))->GetNameRef() == names[i]);
    }
    REQUIRE(styles->GetFeatureCount() == 2);
    for (const auto& [row, table, geometry] : {std::tuple{0, "points", "geom"}, {1, "links", "geom_"}}) {
        const std::unique_ptr<OGRFeature> style(styles->GetNextFeature());
        CHECK(std::string(style->GetFieldAsString("f_table_name")) == table);
        CHECK(std::string(style->GetFieldAsString("f_geometry_column")) == geometry);
        CHECK(std::string(style->GetFieldAsString("f_table_schema")).empty());
        CHECK_FALSE(style->IsFieldNull(style->GetFieldIndex("f_table_catalog")));  // QGIS looks for '', not for null
        CHECK(style->GetFieldAsInteger("useAsDefault") == 1);
        CHECK(style->GetFieldAsString("styleQML") == layers[static_cast<std::size_t>(row)].style);
        CHECK(std::string(style->GetFieldAsString("update_time")).starts_with("2000/01/01"));
    }
    GDALClose(data);
    io::write_geopackage(temp / "plain.gpkg", three_layers(), "");
    data = GDALDataset::Open((temp / "plain.gpkg").c_str(), GDAL_OF_VECTOR);
    CHECK(data->GetLayerCount() == 3);
    GDALClose(data);
}
