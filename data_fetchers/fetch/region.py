# SPDX-License-Identifier: GPL-3.0-or-later
"""The region asked for: a box in degrees, from a box, a point with a radius, or an outline; checked."""
import math
import os
from dataclasses import dataclass

from osgeo import ogr, osr

from problems import UserError

#: WGS 84, m and first eccentricity squared
EQUATORIAL_RADIUS_M, ECCENTRICITY2 = 6378137.0, 0.0066943799901413165
#: Nearer to a pole than this a cell has no width worth a DEM.
LARGEST_LATITUDE = 89.9


@dataclass(frozen=True)
class Box:
    """Degrees; west < east and south < north always."""
    west: float
    south: float
    east: float
    north: float

    def __str__(self):
        return " ".join(f"{value:.10g}" for value in (self.west, self.south, self.east, self.north))

    def grown(self, share):
        """By a share of its size on every side, within the earth."""
        x, y = (self.east - self.west) * share, (self.north - self.south) * share
        return Box(max(self.west - x, -180), max(self.south - y, -90), min(self.east + x, 180), min(self.north + y, 90))

    def area_km2(self):
        """On a sphere; good to half a percent, which a limit needs."""
        band = math.sin(math.radians(self.north)) - math.sin(math.radians(self.south))
        return 6371.0 ** 2 * band * math.radians(self.east - self.west)

    def centre(self):
        return (self.west + self.east) / 2, (self.south + self.north) / 2


def box(west, south, east, north, said="--bbox"):
    """A checked box. UserError says which number is wrong and why."""
    if not all(map(math.isfinite, (west, south, east, north))):
        raise UserError(f"{said} needs four finite numbers")
    for name, value in (("south", south), ("north", north)):
        if abs(value) > 90:
            swapped = " (are longitude and latitude swapped?)" if max(abs(west), abs(east)) <= 90 else ""
            raise UserError(f"{said}: {name} is {value:g}, but latitudes lie between -90 and 90{swapped}")
    for name, value in (("west", west), ("east", east)):
        if abs(value) > 180:
            raise UserError(f"{said}: {name} is {value:g}, but longitudes lie between -180 and 180")
    if south >= north:
        raise UserError(f"{said} is W S E N: south {south:g} must be below north {north:g}")
    if west >= east:
        if west > 0 > east:
            raise UserError(f"{said}: west {west:g} lies east of east {east:g}: over the antimeridian fetch each side by "
                            f"itself ({west:g} to 180 and -180 to {east:g}), else the two are swapped")
        raise UserError(f"{said} is W S E N: west {west:g} must be below east {east:g}")
    if max(abs(south), abs(north)) > LARGEST_LATITUDE:
        raise UserError(f"{said} reaches nearer to a pole than latitude {LARGEST_LATITUDE}, where cells have no width")
    return Box(west, south, east, north)


def around(longitude, latitude, radius_m):
    """The box that holds a circle on the ellipsoid."""
    if not all(map(math.isfinite, (longitude, latitude, radius_m))) or radius_m <= 0:
        raise UserError("--point LON LAT and --radius-m R need finite numbers, and a radius above 0")
    if abs(longitude) > 180 or abs(latitude) > 90:
        raise UserError(f"--point is LON LAT: {longitude:g} {latitude:g} lies outside -180 to 180 and -90 to 90")
    if radius_m > 2e6:
        raise UserError(f"--radius-m {radius_m:g} is more than 2000 km; give a --bbox")
    tall = math.degrees(radius_m / _radii(latitude)[0]) * 1.001  # the curvature changes a little on the way
    south, north = latitude - tall, latitude + tall
    if max(abs(south), abs(north)) > LARGEST_LATITUDE:
        raise UserError(f"--point with --radius-m {radius_m:g} reaches a pole, where cells have no width")
    widest = max(abs(south), abs(north))
    wide = math.degrees(radius_m / (_radii(widest)[1] * math.cos(math.radians(widest))))
    west, east = longitude - wide, longitude + wide
    if west < -180 or east > 180:
        raise UserError("the circle around --point crosses the antimeridian; fetch each side by itself with --bbox")
    return box(west, south, east, north, "--point")


def _radii(latitude):
    """Of curvature, along the meridian and across it, m."""
    w2 = 1 - ECCENTRICITY2 * math.sin(math.radians(latitude)) ** 2
    return EQUATORIAL_RADIUS_M * (1 - ECCENTRICITY2) / w2 ** 1.5, EQUATORIAL_RADIUS_M / math.sqrt(w2)


def wgs84():
    return lonlat(osr.SpatialReference(), "EPSG:4326")


def lonlat(system, text=None):
    """The coordinate system with x, y as longitude, latitude or easting, northing."""
    if text is not None and system.SetFromUserInput(text) != 0:
        raise UserError(f"'{text}' is no coordinate system that PROJ knows")
    system.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return system


def outline(path):
    """The polygons of a vector file as one geometry in degrees, and its box."""
    if not os.path.exists(path):
        raise UserError(f"--outline: no file '{path}'")
    try:
        data = ogr.Open(path)
    except RuntimeError:
        data = None
    if data is None:
        raise UserError(f"--outline: '{path}' is no vector file that GDAL reads (GeoPackage, GeoJSON, shapefile, …)")
    together = ogr.Geometry(ogr.wkbMultiPolygon)
    for i in range(data.GetLayerCount()):
        for polygon in _polygons(data.GetLayer(i)):
            together.AddGeometry(polygon)
    if together.GetGeometryCount() == 0:
        raise UserError(f"--outline: '{path}' holds no polygon")
    west, east, south, north = together.GetEnvelope()
    return together, box(west, south, east, north, f"--outline '{path}'")


def _polygons(layer):
    system = layer.GetSpatialRef()
    change = None
    if system is not None:
        system = lonlat(system.Clone())
        change = None if system.IsSame(wgs84()) else osr.CoordinateTransformation(system, wgs84())
    for feature in layer:
        geometry = feature.GetGeometryRef()
        if geometry is None or ogr.GT_Flatten(geometry.GetGeometryType()) not in (
                ogr.wkbPolygon, ogr.wkbMultiPolygon, ogr.wkbCurvePolygon, ogr.wkbMultiSurface):
            continue
        geometry = geometry.GetLinearGeometry()
        if change is not None:
            geometry.Transform(change)
        geometry.FlattenTo2D()
        many = geometry.GetGeometryType() == ogr.wkbMultiPolygon
        yield from (geometry.GetGeometryRef(i).Clone() for i in range(geometry.GetGeometryCount())) if many else (
            geometry.Clone(),)


def bounds_in(bounds, source, target):
    """West, south, east, north of a rectangle after a change of coordinates, its sides followed."""
    if source.IsSame(target):
        return bounds
    change = osr.CoordinateTransformation(source, target)
    found = change.TransformBounds(*bounds, 21)
    if not all(map(math.isfinite, found)):
        raise UserError("the region does not fit the coordinate system; choose another --crs")
    return tuple(found)
