#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Are the files that `thalweg simulate` writes for other programs what those programs ask for? other_programs.py THALWEG

Solids are read by a few lines of numpy and must be closed, of the right number of handles, and hold what the summary says;
cloud-optimized GeoTIFFs are judged by GDAL's own validator, pictures by Pillow, netCDF by GDAL, GeoPackages by SQLite.
"""
import csv
import functools
import json
import os
import sqlite3
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from osgeo import gdal
from osgeo_utils.samples import validate_cloud_optimized_geotiff
from PIL import Image

gdal.UseExceptions()
THALWEG = None  # from the command line

EXPERIMENT = """
seed = 3
[domain]
{domain}
[uplift]
rate_m_per_yr = 5e-4
[river]
k = 2e-5
m = 0.4
[time]
step_yr = 100000
max_steps = 20
convergence = 0
[output]
resolution = 150
geotiff = "cog"
heightmap = "png"
mesh_file = "{mesh}"
heightfield_mesh_file = "{heightfield}"
solid = true
snapshots_every = 10
"""
LAKE = {"type": "Polygon", "coordinates": [[[0, 0], [9000, 0], [9000, 7000], [4000, 9000], [0, 6000], [0, 0]],
                                           [[3000, 3000], [3000, 4500], [5000, 4600], [4800, 2900], [3000, 3000]]]}
#: name: (domain, mesh format, heightfield format, holes)
CASES = {"TIN": ("size_m = [8000, 6000]\nnodes = 3000", "obj", "ply", 0),
         "TIN around a lake": ('outline = "lake.geojson"\nnodes = 3000', "ply", "obj", 1),
         "raster": ('size_m = [8000, 6000]\nnodes = 3000\nmesh = "raster"', "obj", "ply", 0)}


def read_obj(path):
    with open(path, encoding="ascii") as stream:
        lines = [line.split() for line in stream if line[:2] in ("v ", "f ")]
    vertices = np.array([line[1:] for line in lines if line[0] == "v"], float)
    return vertices, np.array([line[1:] for line in lines if line[0] == "f"], int) - 1


def read_ply(path):
    with open(path, "rb") as stream:
        header = []
        while not header or header[-1] != "end_header":
            header.append(stream.readline().decode("ascii").strip())
        counts = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element")}
        vertices = np.fromfile(stream, "<f8", 3 * counts["vertex"]).reshape(-1, 3)
        faces = np.fromfile(stream, np.dtype([("count", "u1"), ("vertices", "<i4", 3)]), counts["face"])
        left = stream.read()
    assert not left and (faces["count"] == 3).all()
    return vertices, faces["vertices"].astype(int)


def unmatched_edges(faces):
    """Edges that are not run along exactly once each way."""
    runs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there, back = runs[:, 0] * (faces.max() + 1) + runs[:, 1], runs[:, 1] * (faces.max() + 1) + runs[:, 0]
    return len(there) - len(np.unique(there)) + np.setxor1d(there, back).size


def volume(vertices, faces):
    """By the divergence theorem: positive where the faces look outward."""
    a, b, c = (vertices[faces[:, corner]] - vertices.mean(axis=0) for corner in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def of_each_case(test):
    """The test, once for every case: with its name, folder and summary."""
    @functools.wraps(test)
    def tested(self):
        for name, (folder, summary) in self.folders.items():
            with self.subTest(name):
                test(self, name, folder, summary)
    return tested


class OtherPrograms(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folders, cls.volumes_off = {}, {}
        with open(os.path.join(cls.temporary.name, "lake.geojson"), "w", encoding="utf-8") as stream:
            json.dump(LAKE, stream)
        for name, (domain, mesh, heightfield, _) in CASES.items():
            experiment = os.path.join(cls.temporary.name, f"{name}.toml")
            with open(experiment, "w", encoding="utf-8") as stream:
                stream.write(EXPERIMENT.format(domain=domain, mesh=mesh, heightfield=heightfield))
            folder = os.path.join(cls.temporary.name, name)
            subprocess.run([THALWEG, "simulate", experiment, "--out", folder, "--quiet", "--no-figures"], check=True)
            with open(os.path.join(folder, "summary.json"), encoding="utf-8") as stream:
                cls.folders[name] = (folder, json.load(stream))

    @classmethod
    def tearDownClass(cls):
        target = os.environ.get("THALWEG_VALIDATION_OUT")
        if target and cls.volumes_off:
            os.makedirs(target, exist_ok=True)
            with open(os.path.join(target, "solids.csv"), "w", newline="", encoding="utf-8") as stream:
                writer = csv.writer(stream)
                writer.writerow(cls.volumes_off)
                writer.writerow(cls.volumes_off.values())

    @of_each_case
    def test_solids_are_closed_face_outward_and_hold_what_the_summary_says(self, name, folder, summary):
        self.assertEqual(len(summary["meshes"]), 2)
        for told in summary["meshes"]:
            vertices, faces = (read_obj if told["file"].endswith("obj") else read_ply)(os.path.join(folder, told["file"]))
            self.assertEqual((len(vertices), len(faces)), (told["vertices"], told["triangles"]))
            self.assertEqual(unmatched_edges(faces), 0)
            self.assertEqual(np.unique(faces).size, len(vertices))
            handles = CASES[name][3]
            self.assertEqual(len(vertices) - 3 * len(faces) / 2 + len(faces), 2 - 2 * handles)
            off = abs(volume(vertices, faces) / told["volume_m3"] - 1)
            self.assertLess(off, 1e-7 if told["file"].endswith("obj") else 1e-8)  # OBJ: seven digits
            self.volumes_off[f"{name}, {told['file']}"] = off

    @of_each_case
    def test_a_solid_of_the_heightfield_holds_the_heights_of_its_cells(self, name, folder, summary):
        told = next(mesh for mesh in summary["meshes"] if mesh["file"].startswith("heightfield"))
        data = gdal.Open(os.path.join(folder, "elevation.tif"))
        heights, step = data.ReadAsArray(), data.GetGeoTransform()
        prisms = np.nansum(heights - told["base_m"]) * abs(step[1] * step[5])
        self.assertLess(abs(told["volume_m3"] / prisms - 1), 0.05)  # it ends at the outer cells' centres

    @of_each_case
    def test_geotiffs_are_cloud_optimized_by_gdals_own_judgement(self, name, folder, summary):
        for file in ("elevation.tif", "drainage_area.tif"):
            warnings, errors, details = validate_cloud_optimized_geotiff.validate(os.path.join(folder, file), True)
            self.assertEqual((errors, warnings), ([], []), file)
            self.assertIn("ifd_offsets", details)

    @of_each_case
    def test_the_heightmap_is_a_grey_picture_of_16_bits_with_the_heights_of_the_geotiff(self, name, folder, summary):
        scale = summary["heightmap"]
        with Image.open(os.path.join(folder, scale["file"])) as picture:
            self.assertEqual((picture.format, picture.mode[0]), ("PNG", "I"))
            counts = np.array(picture).astype(float)
        with open(os.path.join(folder, scale["file"]), "rb") as stream:
            self.assertEqual(tuple(stream.read(26)[24:]), (16, 0))  # bits and colour type of the header: grey
        heights = gdal.Open(os.path.join(folder, "elevation.tif")).ReadAsArray()
        self.assertEqual(counts.shape, heights.shape)
        np.testing.assert_array_equal(counts == scale["nodata_count"], np.isnan(heights))
        seen = ~np.isnan(heights)
        off = np.abs(scale["offset_m"] + counts * scale["metres_per_count"] - heights)[seen].max()
        self.assertLessEqual(off, 0.5001 * scale["metres_per_count"])
        self.assertEqual((counts[seen].min(), counts[seen].max()), (1, 65535))

    @of_each_case
    def test_snapshots_are_a_netcdf_of_climate_and_forecast_conventions_and_pictures(self, name, folder, summary):
        data = gdal.Open(f'NETCDF:"{os.path.join(folder, "snapshots", "elevation.nc")}":elevation')
        self.assertEqual(data.RasterCount, 3)
        self.assertTrue(data.GetMetadataItem("NC_GLOBAL#Conventions").startswith("CF-1."))
        self.assertEqual(data.GetMetadataItem("elevation#units"), "m")
        last = gdal.Open(os.path.join(folder, "elevation.tif"))
        self.assertEqual((data.RasterXSize, data.RasterYSize), (last.RasterXSize, last.RasterYSize))
        np.testing.assert_allclose(data.GetRasterBand(3).ReadAsArray(), last.ReadAsArray(), rtol=1e-6)
        times = [float(data.GetRasterBand(band).GetMetadataItem("NETCDF_DIM_time")) for band in (1, 2, 3)]
        self.assertEqual(times, [0, summary["time_yr"] / 2, summary["time_yr"]])
        for step in (0, 10, 20):
            with Image.open(os.path.join(folder, "snapshots", f"step-{step:06}.png")) as picture:
                self.assertEqual(picture.size, (last.RasterXSize, last.RasterYSize))

    @of_each_case
    def test_the_network_is_a_geopackage_whose_links_are_those_of_the_summary(self, name, folder, summary):
        with sqlite3.connect(os.path.join(folder, "network.gpkg")) as store:
            self.assertEqual(store.execute("PRAGMA application_id").fetchone()[0], 0x47504B47)
            self.assertEqual(store.execute("PRAGMA integrity_check").fetchone()[0], "ok")
            links = store.execute("SELECT COUNT(*) FROM links").fetchone()[0]
        self.assertEqual(links, summary["terrain"]["channels"]["links"])
        self.assertGreater(links, 10)


if __name__ == "__main__":
    THALWEG = sys.argv.pop(1)
    unittest.main()
