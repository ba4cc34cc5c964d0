// SPDX-License-Identifier: BSD-3-Clause
#include "flight/jsbsim/jsbsim_engine.hpp"

#include <array>
#include <cmath>

#include "config/strict_yaml.hpp"
#include "flight/project_root.hpp"

namespace rosflight::flight {
namespace {

// As in jsbsim_engine.py.
constexpr char kBegin = 'b';
constexpr char kSetState = 's';
constexpr char kMove = 'm';

}  // namespace

/// The memory that both processes share.
struct JsbsimEngine::Block {
  double mass_kg;
  std::array<double, 6> inertia_kg_m2;  ///< xx yy zz xy xz yz
  double gravity_m_s2;
  double step_s;
  std::array<double, 3> force_W;
  std::array<double, 3> torque_B;
  std::array<double, 3> p_W;
  std::array<double, 9> R_WB;  ///< Row by row.
  std::array<double, 3> v_B;
  std::array<double, 3> w_B;
  std::array<char, 256> error;
};

namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

void put(const sim::Vector3& v, std::array<double, 3>& at) {
  Eigen::Map<sim::Vector3>{at.data()} = v;
}

sim::Vector3 vector(const std::array<double, 3>& at) {
  return Eigen::Map<const sim::Vector3>{at.data()};
}

}  // namespace

JsbsimEngine::Options JsbsimEngine::Options::of_project() {
  const std::filesystem::path root = project_root();
  for (const char* environment : {".venv-jsbsim", ".venv"}) {
    const std::filesystem::path python = root / environment / "bin/python3";
    if (std::filesystem::exists(python)) return {python, root / "flight/jsbsim/jsbsim_engine.py"};
  }
  throw config::Error("--physics: found jsbsim without " +
                      (root / ".venv-jsbsim/bin/python3").string() +
                      ", which ./rosflight fly --physics jsbsim makes");
}

JsbsimEngine::JsbsimEngine(const sim::BodyParameters& body, double gravity_m_s2,
                           const Options& options)
    : timeout_{options.timeout},
      program_{"--physics jsbsim", sizeof(Block)},
      block_{static_cast<Block*>(program_.block())} {
  const sim::Matrix3& J = body.inertia_kg_m2;
  block_->mass_kg = body.mass_kg;
  block_->inertia_kg_m2 = {J(0, 0), J(1, 1), J(2, 2), J(0, 1), J(0, 2), J(1, 2)};
  block_->gravity_m_s2 = gravity_m_s2;
  program_.start({options.python.string(), "-E", "-s", options.script.string()});
  command(kBegin, options.start_timeout);
}

JsbsimEngine::~JsbsimEngine() = default;

void JsbsimEngine::command(char what, std::chrono::milliseconds timeout) {
  block_->error.back() = '\0';
  program_.command(what, timeout, block_->error.data());
}

void JsbsimEngine::set_state(const sim::BodyState& state) {
  state_.q_WB = state.q_WB;
  put(state.p_W, block_->p_W);
  Eigen::Map<RowMajor>{block_->R_WB.data()} = state.q_WB.toRotationMatrix();
  put(state.v_B, block_->v_B);
  put(state.w_B, block_->w_B);
  command(kSetState, timeout_);
  read_state();
}

void JsbsimEngine::step(double h_s, const Load& load) {
  block_->step_s = h_s;
  put(load.force_W, block_->force_W);
  put(load.torque_B, block_->torque_B);
  command(kMove, timeout_);
  read_state();
}

void JsbsimEngine::read_state() {
  sim::Quaternion q_WB(sim::Matrix3(Eigen::Map<const RowMajor>{block_->R_WB.data()}));
  // An attitude has two quaternions: the one next to the last, so that the sign does not jump.
  if (q_WB.dot(state_.q_WB) < 0.0) q_WB.coeffs() = -q_WB.coeffs();
  state_ = {vector(block_->p_W), q_WB, vector(block_->v_B), vector(block_->w_B)};
  const double sum = state_.p_W.sum() + q_WB.coeffs().sum() + state_.v_B.sum() + state_.w_B.sum();
  if (!std::isfinite(sum)) program_.give_up("its state is not finite");
}

}  // namespace rosflight::flight
