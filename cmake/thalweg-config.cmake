# SPDX-License-Identifier: GPL-3.0-or-later
# Installed: what find_package(thalweg) reads. The libraries are static, so what they stand on must be found again.
include(CMakeFindDependencyMacro)
foreach(dependency TBB Eigen3 fmt CGAL GDAL Ceres tomlplusplus nlohmann_json OpenSSL embree)
  find_dependency(${dependency})
endforeach()
include(${CMAKE_CURRENT_LIST_DIR}/thalweg-targets.cmake)
