// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/gazebo_engine.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "config/strict_yaml.hpp"
#include "flight/project_root.hpp"
#include "log/checksums.hpp"
#include "messages/frames.hpp"

namespace rosflight::flight {
namespace {

using gazebo::Triple;
using messages::enu;  // takes W to G, and G to W
using sim::Matrix3;
using sim::Vector3;
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// A body that is put back by less than this is not checked again.
constexpr double kSamePlace_m = 0.001;
constexpr double kSamePlace_rad = 0.001;

static_assert(gazebo::kCommandsFd == EngineProcess::kCommandsFd &&
              gazebo::kAnswersFd == EngineProcess::kAnswersFd &&
              gazebo::kBlockFd == EngineProcess::kBlockFd &&
              gazebo::kReady == EngineProcess::kReady &&
              gazebo::kSteep == sim::PhysicsEngine::kSteep);

void to_block(const Vector3& v, Triple& at) {
  Eigen::Map<Vector3>{at.data()} = v;
}

Vector3 from_block(const Triple& at) {
  return Eigen::Map<const Vector3>{at.data()};
}

/// R_GL of R_WB, and back: the axes change places and signs, without rounding.
Matrix3 other_axes(const Matrix3& R) {
  Matrix3 out;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vector3 column = enu(R.col(k));
    out.col(k) = k == 0 ? column : Vector3(-column);
  }
  return out;
}

/// A file without a name that holds the text. @throws boards::EmulatorError
base::FileDescriptor memory_file(const std::string& text) {
  base::FileDescriptor file{::memfd_create("rosflight_model", MFD_CLOEXEC)};
  std::size_t done = 0;
  while (file.valid() && done < text.size()) {
    const ssize_t count = ::write(file.get(), text.data() + done, text.size() - done);
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  if (!file.valid() || done < text.size())
    throw boards::EmulatorError("--physics gazebo: cannot give the model to its process");
  return file;
}

std::vector<std::string> lines_of(int fd) {
  std::string text(static_cast<std::size_t>(std::max<off_t>(::lseek(fd, 0, SEEK_END), 0)), '\0');
  const ssize_t count = ::pread(fd, text.data(), text.size(), 0);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  std::istringstream stream(text);
  std::vector<std::string> out;
  for (std::string line; std::getline(stream, line);) out.push_back(line);
  return out;
}

}  // namespace

std::filesystem::path GazeboEngine::Options::program_of_project() {
  return project_root() / "build/gazebo/flight/gazebo/engine/gazebo_engine";
}

GazeboEngine::Options GazeboEngine::Options::of_project() {
  Options options;
  options.program = program_of_project();
  if (std::filesystem::exists(options.program)) return options;
  throw config::Error("--physics: found gazebo without " + options.program.string() +
                      ", which ./rosflight fly --physics gazebo builds");
}

GazeboEngine::GazeboEngine(const std::string& model_sdf, double gravity_m_s2,
                           const Options& options)
    : has_world_{!options.world_file.empty()},
      timeout_{options.timeout},
      program_{"--physics gazebo", sizeof(gazebo::Block)},
      block_{static_cast<gazebo::Block*>(program_.block())} {
  block_->gravity_m_s2 = gravity_m_s2;
  block_->max_height_m = options.max_height_m;
  const base::FileDescriptor model = memory_file(model_sdf);
  std::vector<std::string> arguments{options.program.string()};
  if (has_world_) arguments.push_back(options.world_file);
  const base::FileDescriptor list = memory_file("");
  program_.start(arguments, {{model.get(), gazebo::kModelFd}, {list.get(), gazebo::kFilesFd}});
  command(gazebo::kBegin, options.start_timeout);
  world_files_ = lines_of(list.get());
}

std::string GazeboEngine::world_sha256() const {
  if (world_files_.empty()) return {};
  log::Sha256 sum;
  std::array<std::uint8_t, 65536> part{};
  for (const std::string& file : world_files_) {
    std::ifstream stream(file, std::ios::binary);
    while (stream) {
      stream.read(reinterpret_cast<char*>(part.data()), part.size());
      sum.update({part.data(), static_cast<std::size_t>(stream.gcount())});
    }
  }
  return sum.hex();
}

void GazeboEngine::command(char what, std::chrono::milliseconds timeout) {
  block_->error.back() = '\0';
  program_.command(what, timeout, block_->error.data());
}

void GazeboEngine::set_state(const sim::BodyState& state) {
  const bool elsewhere = !placed_ || (state.p_W - state_.p_W).norm() > kSamePlace_m ||
                         state.q_WB.angularDistance(state_.q_WB) > kSamePlace_rad;
  state_.q_WB = state.q_WB;
  const Matrix3 R_WB = state.q_WB.toRotationMatrix();
  to_block(enu(state.p_W), block_->p_G);
  Eigen::Map<RowMajor>{block_->R_GL.data()} = other_axes(R_WB);
  to_block(enu(R_WB * state.v_B), block_->v_G);
  to_block(enu(R_WB * state.w_B), block_->w_G);
  command(has_world_ && elsewhere ? gazebo::kPlace : gazebo::kSetState, timeout_);
  placed_ = true;
  contact_ = {};
  read_state();
}

void GazeboEngine::step(double h_s, const Load& load) {
  const sim::Quaternion q_WB = state_.q_WB;
  block_->step_s = h_s;
  to_block(enu(load.force_W), block_->force_G);
  to_block(enu(q_WB * load.torque_B), block_->torque_G);
  command(gazebo::kMove, timeout_);
  read_state();
  read_contact(q_WB);
}

void GazeboEngine::read_state() {
  const Matrix3 R_WB = other_axes(Eigen::Map<const RowMajor>{block_->R_GL.data()});
  sim::Quaternion q_WB(R_WB);
  // An attitude has two quaternions: the one next to the last, so that the sign does not jump.
  if (q_WB.dot(state_.q_WB) < 0.0) q_WB.coeffs() = -q_WB.coeffs();
  state_ = {enu(from_block(block_->p_G)), q_WB, R_WB.transpose() * enu(from_block(block_->v_G)),
            R_WB.transpose() * enu(from_block(block_->w_G))};
  const double sum = state_.p_W.sum() + q_WB.coeffs().sum() + state_.v_B.sum() + state_.w_B.sum();
  if (!std::isfinite(sum)) program_.give_up("its state is not finite");
}

void GazeboEngine::read_contact(const sim::Quaternion& q_WB) {
  contact_.touches = block_->touches != 0;
  contact_.airframe = block_->airframe_touches != 0;
  contact_.carries = block_->carries != 0;
  contact_.approach_m_s = block_->approach_m_s;
  contact_.normal_up = block_->normal_up;
  block_->other.back() = '\0';
  contact_.other = block_->other.data();
  contact_.wrench.force_B = q_WB.conjugate() * enu(from_block(block_->contact_force_G));
  contact_.wrench.torque_B = q_WB.conjugate() * enu(from_block(block_->contact_torque_G));
}

}  // namespace rosflight::flight
