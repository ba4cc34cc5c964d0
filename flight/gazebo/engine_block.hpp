// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>

/// What `rosflight` and the program gazebo_engine share: commands over a pipe, numbers in a block of memory.
///
/// Axes are those of Gazebo: the world's G x east, y north, z up; those of link `base_link`, L, forward, left, up
/// with its origin at the centre of mass. No header of Gazebo is needed to read this.
namespace rosflight::flight::gazebo {

// File descriptors of the program.
inline constexpr int kCommandsFd = 3;
inline constexpr int kAnswersFd = 4;
inline constexpr int kBlockFd = 5;
inline constexpr int kModelFd = 6;  ///< The vehicle as SDF, with the link `base_link`.

inline constexpr int kFilesFd =
    7;  ///< There the program writes which files the world is made of, one a line.

// Commands, one byte each, and the answers to them. After kFailed the program ends.
inline constexpr char kBegin = 'b';
inline constexpr char kSetState = 's';
inline constexpr char kPlace =
    'p';  ///< As kSetState; fails if the vehicle is inside a body of the world or not above its ground.
inline constexpr char kMove = 'm';
inline constexpr char kReady = 'r';
inline constexpr char kFailed = 'e';

inline constexpr double kSteep = 0.5;  ///< Cosine of 60 degrees.

using Triple = std::array<double, 3>;

struct Block {
  double gravity_m_s2;
  double max_height_m;  ///< Above the ground, for kPlace.
  double step_s;
  Triple force_G;   ///< At the centre of mass [N].
  Triple torque_G;  ///< [N m]
  // State.
  Triple p_G;
  std::array<double, 9> R_GL;  ///< Row by row.
  Triple v_G;                  ///< Velocity of the centre of mass.
  Triple w_G;
  // Contacts of the last step.
  Triple contact_force_G;
  Triple contact_torque_G;  ///< About the centre of mass.
  double
      approach_m_s;  ///< Largest speed of a point that touches, along the normal and towards the other body.
  double normal_up;  ///< There: z of the normal of the surface, 1 on level ground, 0 at a wall.
  std::int32_t touches;
  std::int32_t airframe_touches;  ///< Body, wing or a propeller, not the gear.
  std::int32_t carries;           ///< A surface touches whose normal_up is kSteep or more.
  std::array<char, 64> other;     ///< Model of the world at the fastest of these points.
  std::array<char, 1024> error;   ///< One line, which may have two long paths.
};

}  // namespace rosflight::flight::gazebo
