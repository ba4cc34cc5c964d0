// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The one place that knows which release of Gazebo is there: ignition-gazebo 6 (Fortress), or gz-sim 8 and 10 (Harmonic, Jetty)
// with ROSFLIGHT_GZ_SIM, which have other names for the same.
#ifdef ROSFLIGHT_GZ_SIM
#include <gz/plugin/Register.hh>
#include <gz/sim/Events.hh>
#include <gz/sim/Link.hh>
#include <gz/sim/Model.hh>
#include <gz/sim/System.hh>
#include <gz/sim/Util.hh>
#include <gz/sim/components/AngularVelocityCmd.hh>
#include <gz/sim/components/Inertial.hh>
#include <gz/sim/components/LinearVelocityCmd.hh>
#include <gz/sim/components/PoseCmd.hh>
namespace gazebo_sim = gz::sim;
namespace gazebo_math = gz::math;
#define ROSFLIGHT_ADD_GAZEBO_SYSTEM GZ_ADD_PLUGIN
#else
#include <ignition/gazebo/Events.hh>
#include <ignition/gazebo/Link.hh>
#include <ignition/gazebo/Model.hh>
#include <ignition/gazebo/System.hh>
#include <ignition/gazebo/Util.hh>
#include <ignition/gazebo/components/AngularVelocityCmd.hh>
#include <ignition/gazebo/components/Inertial.hh>
#include <ignition/gazebo/components/LinearVelocityCmd.hh>
#include <ignition/gazebo/components/PoseCmd.hh>
#include <ignition/plugin/Register.hh>
namespace gazebo_sim = ignition::gazebo;
namespace gazebo_math = ignition::math;
#define ROSFLIGHT_ADD_GAZEBO_SYSTEM IGNITION_ADD_PLUGIN
#endif
