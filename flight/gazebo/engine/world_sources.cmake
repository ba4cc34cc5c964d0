# SPDX-License-Identifier: BSD-3-Clause
# The world of dartsim without the program: sources of gazebo_engine, and of the stand-in for Gazebo in ros/rosflight_sim/gazebo.
# They need tinyxml2 beside Gazebo's libraries, whose readers of SDF and meshes use it too.
set(dartsim_world_sources dart_world.cpp ground_below.cpp mesh_indices.cpp meshes.cpp sdf_files.cpp)
list(TRANSFORM dartsim_world_sources PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
