// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster_place.hpp"

#include <fmt/format.h>

#include <GeographicLib/Geodesic.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string_view>

#include "io/crs_text.hpp"
#include "io/gdal_guard.hpp"
#include "io/utm_zone.hpp"
#include "thalweg/core/error.hpp"
#include "thalweg/io/geodesy.hpp"

namespace thalweg::io {
namespace {

using Affine = std::array<double, 6>;

constexpr const char* make_sure =
    "make sure that it is right (--crs tells the DEM's own, --reproject another to warp to)";

Affine upright_transform(GDALDataset& dataset, const std::string& name) {
    Affine t{};
    const bool given = dataset.GetGeoTransform(t.data()) == CE_None;
    const bool identity = t[0] == 0 && t[1] == 1 && t[2] == 0 && t[3] == 0 && t[4] == 0 && std::abs(t[5]) == 1;
    if (!given && dataset.GetGCPCount() > 0) {
        throw Error(fmt::format("{} is placed by ground control points only: warp it with gdalwarp first", name));
    }
    if (!given || identity) {
        throw Error(
            fmt::format("{} has no geotransform, so its cell size and place are unknown: "
                        "set them with gdal_translate -a_ullr",
                        name));
    }
    for (const double value : t) {
        if (!std::isfinite(value)) throw Error(fmt::format("{} has a geotransform that is not finite", name));
    }
    // A hundredth of a cell over the whole raster is rounding, not rotation.
    const double drift =
        std::max(std::abs(t[2] * dataset.GetRasterYSize() / t[1]), std::abs(t[4] * dataset.GetRasterXSize() / t[5]));
    if (!(drift < 0.01) || t[1] <= 0) {
        throw Error(fmt::format("{} is rotated or mirrored: turn it north-up with gdalwarp first", name));
    }
    return t;
}

/// `for_the_place` is named where the text cannot be understood.
std::optional<OGRSpatialReference> crs_from_text(const std::string& text, const std::string& for_the_place) {
    OGRSpatialReference crs;
    const char* const options[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
    if (crs.SetFromUserInput(text.c_str(), options) != OGRERR_NONE) {
        throw Error(fmt::format("\"{}\" is no coordinate system that can be understood ({})", text,
                                try_instead(text, for_the_place)));
    }
    return crs;
}

/// Corners that could be longitudes and latitudes, of cells that could be a DEM's; a corner at the origin is what
/// synthetic rasters have.
bool plausible_degrees(const Placement& p, double rows, double cols) {
    const double east = p.west + cols * p.cell_width;
    const double south = p.north - rows * p.cell_height;
    const bool at_origin = p.west == 0 && (south == 0 || p.north == 0);
    return p.west >= -180 && east <= 180 && south >= -90 && p.north <= 90 && p.cell_width < 1 && p.cell_height < 1 &&
           !at_origin;
}

std::optional<OGRSpatialReference> stated_crs(const GDALDataset& dataset) {
    const OGRSpatialReference* own = dataset.GetSpatialRef();
    if (own == nullptr || own->IsEmpty()) return std::nullopt;
    return *own;
}

std::string epsg_or_name(OGRSpatialReference crs) {
    if (crs.GetAuthorityCode(nullptr) == nullptr) crs.AutoIdentifyEPSG();
    const char* authority = crs.GetAuthorityName(nullptr);
    const char* code = crs.GetAuthorityCode(nullptr);
    if (authority != nullptr && code != nullptr) return fmt::format("{}:{}", authority, code);
    const char* name = crs.GetName();
    return name == nullptr ? "" : name;
}

/// Metres per unit of a band's unit name; 0 where the name is not known.
double metres_per(std::string unit) {
    std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return std::tolower(c); });
    constexpr double us_foot = 1200.0 / 3937.0;
    static const std::array<std::pair<const char*, double>, 25> known{{
        {"m", 1},
        {"metre", 1},
        {"meter", 1},
        {"metres", 1},
        {"meters", 1},
        {"ft", 0.3048},
        {"foot", 0.3048},
        {"feet", 0.3048},
        {"international foot", 0.3048},
        {"us survey foot", us_foot},
        {"us survey feet", us_foot},
        {"us_survey_foot", us_foot},
        {"foot_us", us_foot},
        {"ftus", us_foot},
        {"us-ft", us_foot},
        {"sfoot", us_foot},
        {"us foot", us_foot},
        {"cm", 0.01},
        {"centimetre", 0.01},
        {"dm", 0.1},
        {"decimetre", 0.1},
        {"mm", 0.001},
        {"millimetre", 0.001},
        {"km", 1000},
        {"kilometre", 1000},
    }};
    for (const auto& [name, metres] : known) {
        if (unit == name) return metres;
    }
    return 0;
}

/// The unit that the band states, else the vertical part of a compound coordinate system, else metres.
void find_vertical_unit(GDALDataset& dataset, const OGRSpatialReference* crs, const std::string& name,
                        ReadResult& result) {
    const std::string unit = dataset.GetRasterBand(1)->GetUnitType();
    const double stated = metres_per(unit);
    if (stated > 0) {
        result.vertical_unit_m = stated;
        return;
    }
    if (!unit.empty()) {
        result.warnings.push_back(
            fmt::format("{} states its heights in \"{}\", which is no known unit of length: "
                        "they are taken as metres",
                        name, unit));
    }
    if (crs == nullptr) return;
    if (crs->IsCompound()) {
        result.vertical_unit_m = crs->GetTargetLinearUnits("VERT_CS");
    } else if (unit.empty() && crs->IsProjected() && std::abs(crs->GetLinearUnits() - 1) > 1e-9) {
        const char* plane_unit = nullptr;
        crs->GetLinearUnits(&plane_unit);
        result.warnings.push_back(
            fmt::format("{} lies on a plane measured in {} but does not state the unit of its "
                        "heights: they are taken as metres (if they are feet, say so with "
                        "gdal_edit.py -units ft)",
                        name, plane_unit));
    }
}

/// Whether a longitude and latitude lead back to the place on the map. A map that reaches around the earth gives every
/// easting a longitude, those beyond its edge that of another place.
bool leads_back(const OGRCoordinateTransformation& change, Point place, Point longitude_latitude, double rounding) {
    auto [x, y] = longitude_latitude;
    if (!std::isfinite(x) || !(std::abs(y) <= 90)) return false;
    const std::unique_ptr<OGRCoordinateTransformation> back(change.GetInverse());
    return back && back->Transform(1, &x, &y) && std::abs(x - place.x) <= rounding && std::abs(y - place.y) <= rounding;
}

/// Ratio of lengths on the map to lengths on the ellipsoid around the raster's middle, west to east; 0 if unknown,
/// infinite where the middle lies beyond the map's edge.
/// Throws Error where the coordinates cannot be those of the coordinate system.
double map_scale(const Placement& p, Index rows, Index cols, const OGRSpatialReference& crs, const std::string& name) {
    const GdalGuard gdal;  // what is said here is no damage of the file
    OGRSpatialReference plane(crs);
    plane.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRSpatialReference> sphere(plane.CloneGeogCS());
    if (!sphere) return 0;
    sphere->SetAngularUnits(SRS_UA_DEGREE, std::numbers::pi / 180);  // some have grads
    sphere->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> change(OGRCreateCoordinateTransformation(&plane, sphere.get()));
    const Point middle = p.center(rows / 2, cols / 2);
    const std::array<double, 2> x{middle.x - p.cell_width / 2, middle.x + p.cell_width / 2};
    const std::array<double, 2> y{middle.y, middle.y};
    std::array<double, 2> longitude = x, latitude = y;
    if (!change) return 0;
    if (!change->Transform(2, longitude.data(), latitude.data())) {
        throw Error(fmt::format(
            "the middle of {}, ({:.10g}, {:.10g}), is no place on the earth in its coordinate system ({}): {}", name,
            middle.x, middle.y, epsg_or_name(crs), make_sure));
    }
    const double rounding = std::max({p.cell_width, p.cell_height, 1 / crs.GetLinearUnits()});  // a cell or a metre
    if (!leads_back(*change, {x[0], y[0]}, {longitude[0], latitude[0]}, rounding)) {
        return std::numeric_limits<double>::infinity();
    }
    double f = crs.GetInvFlattening();
    f = f == 0 ? 0 : 1 / f;
    double ground = 0;
    GeographicLib::Geodesic(crs.GetSemiMajor(), f)
        .Inverse(latitude[0], longitude[0], latitude[1], longitude[1], ground);
    return ground > 0 ? p.cell_width * crs.GetLinearUnits() / ground : 0;
}

/// What the EPSG has under the system's number: a file's own words seldom tell of the area.
std::optional<OGRSpatialReference> as_registered(const OGRSpatialReference& crs) {
    const std::string name = epsg_or_name(crs);
    return name.starts_with("EPSG:") ? system_of_number(name.substr(5)) : std::nullopt;
}

bool true_to_scale(double scale) { return std::abs(scale - 1) < 0.01; }

/// Where the system is made for, as its authority says, lies elsewhere. Neighbours use it too: a degree is allowed, and
/// a transverse Mercator map reaches as far west and east as its lengths hold (Norway's zone 33 is the whole
/// country's), in a UTM zone south and north too (Landsat's are northern everywhere). `scale` is the map's.
void warn_of_foreign_area(const Placement& p, Index rows, Index cols, const OGRSpatialReference& crs, double scale,
                          const std::string& name, ReadResult& result) {
    constexpr double margin_deg = 1;
    double west = 0, south = 0, east = 0, north = 0;
    const char* area = nullptr;
    const std::optional<Point> middle = middle_in_degrees(p, rows, cols);
    const std::optional<OGRSpatialReference> known = as_registered(crs);
    if (!middle || !known || !known->GetAreaOfUse(&west, &south, &east, &north, &area) || south < -90) return;
    const char* const projection = known->GetAttrValue("PROJECTION");
    const bool holds = projection != nullptr && true_to_scale(scale) &&
                       std::string_view(projection).starts_with(SRS_PT_TRANSVERSE_MERCATOR);
    const double wide = std::remainder(east - west, 360.0) + (std::remainder(east - west, 360.0) <= 0 ? 360 : 0);
    const double beyond = std::abs(std::remainder(middle->x - (west + wide / 2), 360.0)) - wide / 2;
    const bool in_columns = holds || beyond <= margin_deg;
    const bool in_rows =
        (holds && known->GetUTMZone() != 0) || (middle->y >= south - margin_deg && middle->y <= north + margin_deg);
    if (in_columns && in_rows) return;
    result.warnings.push_back(
        fmt::format("the middle of {} lies at {:.2f} degrees east, {:.2f} north in its coordinate system ({}), outside "
                    "of {:g} to {:g} east and {:g} to {:g} north, for which that is made: {}",
                    name, middle->x, middle->y, epsg_or_name(crs), west, east, south, north, make_sure));
}

void warn_of_unfit_map(const Placement& p, Index rows, Index cols, const OGRSpatialReference& crs,
                       const std::string& name, ReadResult& result) {
    const double scale = map_scale(p, rows, cols, crs, name);
    if (std::isinf(scale)) {
        const Point middle = p.center(rows / 2, cols / 2);
        result.warnings.push_back(
            fmt::format("the middle of {}, ({:.10g}, {:.10g}), lies beyond the edge of the earth on the map of its "
                        "coordinate system ({}): lengths, areas and slopes are the map's; {}",
                        name, middle.x, middle.y, epsg_or_name(crs), make_sure));
        return;
    }
    warn_of_foreign_area(p, rows, cols, crs, scale, name, result);
    if (scale == 0 || true_to_scale(scale)) return;
    result.warnings.push_back(fmt::format(
        "lengths on the map of {} are {:.1f} % {} than on the ground: lengths, areas and slopes are the map's "
        "(--reproject warps it to a coordinate system made for the place)",
        name, 100 * std::abs(scale - 1), scale > 1 ? "longer" : "shorter"));
}

Grid degrees_grid(const Placement& p, Index rows, Index cols, const OGRSpatialReference& crs, const std::string& name) {
    if (std::abs(crs.GetAngularUnits() * 180 / std::numbers::pi - 1) > 1e-9) {
        throw Error(
            fmt::format("{} has longitudes in another unit than degrees: reproject it with gdalwarp -t_srs "
                        "EPSG:4326",
                        name));
    }
    const double inverse = crs.GetInvFlattening();
    try {
        return geographic_grid(rows, cols, p.north, p.cell_width, p.cell_height, crs.GetSemiMajor(),
                               inverse == 0 ? 0 : 1 / inverse);
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", name, error.what()));
    }
}

/// Water does not find its way across the edge of the raster, although the earth goes on there.
void warn_of_seam(const Placement& p, Index cols, const std::string& name, ReadResult& result) {
    if (cols * p.cell_width < 360 - 1.5 * p.cell_width) return;
    result.warnings.push_back(fmt::format(
        "{} reaches around the earth: its west and east edges are one meridian, yet water leaves there", name));
}

void warn_of_degrees(const Placement& p, Index rows, Index cols, const std::string& crs_name, const std::string& name,
                     ReadResult& result) {
    if (!plausible_degrees(p, rows, cols)) return;
    result.warnings.push_back(
        fmt::format("the coordinates of {} look like degrees, and its cells are {:.3g} wide, but its coordinate system "
                    "({}) is a plane: if they are longitudes and latitudes, give --crs EPSG:4326",
                    name, p.cell_width, crs_name));
}

void measure_plane(Raster& raster, Index rows, Index cols, double unit_m) {
    raster.grid = plane_grid(rows, cols, raster.placement.cell_width * unit_m, raster.placement.cell_height * unit_m);
}

void place_without_crs(Index rows, Index cols, const std::string& name, ReadResult& result) {
    Placement& p = result.raster.placement;
    if (!plausible_degrees(p, rows, cols)) {
        result.warnings.push_back(
            fmt::format("{} states no coordinate system: its coordinates are taken as metres (or give --crs)", name));
        measure_plane(result.raster, rows, cols, 1);
        return;
    }
    result.warnings.push_back(
        fmt::format("{} states no coordinate system, but its coordinates look like degrees: "
                    "taken as WGS 84 longitude and latitude (or give --crs)",
                    name));
    OGRSpatialReference wgs84;
    wgs84.SetWellKnownGeogCS("WGS84");
    p.geographic = true;
    p.crs_wkt = wkt_of(wgs84);
    result.crs_name = "EPSG:4326";
    result.raster.grid = degrees_grid(p, rows, cols, wgs84, name);
    warn_of_seam(p, cols, name, result);
}

void place_with_crs(OGRSpatialReference crs, Index rows, Index cols, const std::string& name, ReadResult& result) {
    Placement& p = result.raster.placement;
    if (crs.IsCompound()) crs.StripVertical();
    if (!crs.IsGeographic() && !crs.IsProjected()) {
        throw Error(fmt::format("the coordinate system of {} ({}) is neither geographic nor projected: {}", name,
                                crs.GetName() == nullptr ? "unnamed" : crs.GetName(), make_sure));
    }
    p.geographic = crs.IsGeographic();
    p.crs_wkt = wkt_of(crs);
    result.crs_name = epsg_or_name(crs);
    if (p.geographic) {
        result.raster.grid = degrees_grid(p, rows, cols, crs, name);
        warn_of_seam(p, cols, name, result);
        warn_of_foreign_area(p, rows, cols, crs, 1, name, result);
        return;
    }
    measure_plane(result.raster, rows, cols, crs.GetLinearUnits());
    warn_of_degrees(p, rows, cols, result.crs_name, name, result);
    warn_of_unfit_map(p, rows, cols, crs, name, result);
}

}  // namespace

RowOrder place_raster(GDALDataset& dataset, const std::string& name, const std::string& crs_override,
                      ReadResult& result) {
    const Affine t = upright_transform(dataset, name);
    const auto rows = static_cast<Index>(dataset.GetRasterYSize());
    const auto cols = static_cast<Index>(dataset.GetRasterXSize());
    const RowOrder order = t[5] > 0 ? RowOrder::south_to_north : RowOrder::north_to_south;
    Placement& p = result.raster.placement;
    p.west = t[0];
    p.north = order == RowOrder::south_to_north ? t[3] + rows * t[5] : t[3];
    p.cell_width = t[1];
    p.cell_height = std::abs(t[5]);
    const std::optional<OGRSpatialReference> own = stated_crs(dataset);
    if (own) p.crs_wkt = wkt_of(*own);
    const std::optional<OGRSpatialReference> crs =
        crs_override.empty() ? own : crs_from_text(crs_override, system_for(p, rows, cols));
    // A horizontal system given by the user leaves the file's own word on heights standing.
    const std::optional<OGRSpatialReference>& vertical = own && own->IsCompound() ? own : crs;
    find_vertical_unit(dataset, vertical ? &*vertical : nullptr, name, result);
    if (crs) {
        place_with_crs(*crs, rows, cols, name, result);
    } else {
        place_without_crs(rows, cols, name, result);
    }
    return order;
}

}  // namespace thalweg::io
