// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The one place that knows which release of Gazebo's libraries is there: ignition-physics 5 with sdformat 12, or
// gz-physics 7 with sdformat 14, whose names differ in their namespace.
#ifdef ROSFLIGHT_GZ_PHYSICS
#include <gz/common/Console.hh>
#include <gz/common/Mesh.hh>
#include <gz/common/MeshManager.hh>
#include <gz/common/SubMesh.hh>
#include <gz/physics/ForwardStep.hh>
#include <gz/physics/FreeGroup.hh>
#include <gz/physics/GetContacts.hh>
#include <gz/physics/GetEntities.hh>
#include <gz/physics/InstallationDirectories.hh>
#include <gz/physics/Link.hh>
#include <gz/physics/RequestEngine.hh>
#include <gz/physics/World.hh>
#include <gz/physics/config.hh>
#include <gz/physics/mesh/MeshShape.hh>
#include <gz/physics/sdf/ConstructCollision.hh>
#include <gz/physics/sdf/ConstructLink.hh>
#include <gz/physics/sdf/ConstructModel.hh>
#include <gz/physics/sdf/ConstructWorld.hh>
#include <gz/plugin/Loader.hh>
namespace gazebo_common = gz::common;
namespace gazebo_math = gz::math;
namespace gazebo_physics = gz::physics;
namespace gazebo_plugin = gz::plugin;
inline constexpr const char* kDartPlugin = "gz::physics::dartsim::Plugin";
inline constexpr const char* kDartPackage = "libgz-physics7-dartsim of Gazebo's package repository";
/// A function there: the macro of the folder makes a warning.
inline std::string dart_library() {
  return gazebo_physics::getEngineInstallDir() + "/libgz-physics-dartsim-plugin.so";
}
#else
#include <ignition/common/Console.hh>
#include <ignition/common/Mesh.hh>
#include <ignition/common/MeshManager.hh>
#include <ignition/common/SubMesh.hh>
#include <ignition/physics/ForwardStep.hh>
#include <ignition/physics/FreeGroup.hh>
#include <ignition/physics/GetContacts.hh>
#include <ignition/physics/GetEntities.hh>
#include <ignition/physics/Link.hh>
#include <ignition/physics/RequestEngine.hh>
#include <ignition/physics/World.hh>
#include <ignition/physics/config.hh>
#include <ignition/physics/mesh/MeshShape.hh>
#include <ignition/physics/sdf/ConstructCollision.hh>
#include <ignition/physics/sdf/ConstructLink.hh>
#include <ignition/physics/sdf/ConstructModel.hh>
#include <ignition/physics/sdf/ConstructWorld.hh>
#include <ignition/plugin/Loader.hh>
namespace gazebo_common = ignition::common;
namespace gazebo_math = ignition::math;
namespace gazebo_physics = ignition::physics;
namespace gazebo_plugin = ignition::plugin;
inline constexpr const char* kDartPlugin = "ignition::physics::dartsim::Plugin";
/// The run-time package has the file with the number of its interface alone.
inline std::string dart_library() {
  return IGNITION_PHYSICS_ENGINE_INSTALL_DIR "/libignition-physics5-dartsim-plugin.so.5";
}
inline constexpr const char* kDartPackage = "libignition-physics5-dartsim-plugin5";
#endif
#include <sdf/sdf.hh>
#include <string>
