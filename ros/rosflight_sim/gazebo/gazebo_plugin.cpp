// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "body_claim.hpp"
#include "dynamics_loop.hpp"
#include "flight/gazebo/coupling/vehicle_choice.hpp"
#include "flight/gazebo/coupling/whole_loop.hpp"
#include "gazebo_names.hpp"

namespace rosflight_sim {
namespace {

using gazebo::LinkState;
using gazebo_math::Pose3d;
using gazebo_math::Vector3d;
using gazebo_sim::Entity;
using gazebo_sim::EntityComponentManager;
namespace components = gazebo_sim::components;

sim::Vector3 ours(const Vector3d& v) {
  return {v.X(), v.Y(), v.Z()};
}

Vector3d gazebos(const sim::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

Pose3d pose_of(const LinkState& link) {
  const sim::Quaternion& q = link.q_GL;
  return {gazebos(link.p_G), gazebo_math::Quaterniond(q.w(), q.x(), q.y(), q.z())};
}

gazebo::PluginElements elements_of(const sdf::Element& plugin) {
  gazebo::PluginElements out;
  for (auto child = plugin.GetFirstElement(); child; child = child->GetNextElement())
    out.emplace_back(child->GetName(), child->Get<std::string>());
  return out;
}

}  // namespace

/// A system of Gazebo on the model of a vehicle: passes state and wrench of one link between Gazebo and a LinkLoop, and
/// does no more. What is wrong is one line on stderr; Gazebo then runs on, and the vehicle is a body without forces.
class GazeboPlugin final : public gazebo_sim::System,
                           public gazebo_sim::ISystemConfigure,
                           public gazebo_sim::ISystemPreUpdate,
                           public gazebo_sim::ISystemPostUpdate {
 public:
  void Configure(const Entity& entity, const std::shared_ptr<const sdf::Element>& sdf,
                 EntityComponentManager& ecm, gazebo_sim::EventManager& events) override {
    events_ = &events;
    model_ = gazebo_sim::Model(entity);
    try {
      if (!model_.Valid(ecm))
        throw std::runtime_error("found the plugin in no <model>, allowed inside one");
      name_ = model_.Name(ecm);
      begin(gazebo::read_plugin_options(elements_of(*sdf)), ecm);
    } catch (const std::exception& error) {
      say(std::string(error.what()) + "; the vehicle is without forces");
    }
  }

  void PreUpdate(const gazebo_sim::UpdateInfo& info, EntityComponentManager& ecm) override {
    if (!coupling_) return;
    remove_commands(ecm);
    const gazebo::StepCommand command = coupling_->before_step(time_of(info));
    if (command.place) {
      place(*command.place, ecm);
    } else if (!info.paused && coupling_->works()) {  // Gazebo would keep it until it moves
      link_.AddWorldWrench(ecm, gazebos(command.wrench.force_G), gazebos(command.wrench.torque_G));
    }
    if (command.run == gazebo::Run::kStop) {
      events_->Emit<gazebo_sim::events::Stop>();
    } else if (command.run) {
      events_->Emit<gazebo_sim::events::Pause>(command.run == gazebo::Run::kPause);
    }
  }

  void PostUpdate(const gazebo_sim::UpdateInfo& info, const EntityComponentManager& ecm) override {
    if (coupling_) coupling_->after_step(time_of(info), state(ecm));
  }

 private:
  static gazebo::LinkCoupling::Time time_of(const gazebo_sim::UpdateInfo& info) {
    return {info.simTime, info.dt, info.paused};
  }

  void say(const std::string& line) const {
    std::cerr << "rosflight_gazebo_plugin: " + name_ + ": " + line + "\n" << std::flush;
  }

  void begin(const gazebo::PluginOptions& options, EntityComponentManager& ecm) {
    const Entity link = model_.LinkByName(ecm, options.link);
    if (link == gazebo_sim::kNullEntity)
      throw std::runtime_error("found no link " + options.link +
                               " in the model, allowed <link> with one of its links");
    claim_.emplace(&ecm, link, name_ + "::" + options.link);
    link_ = gazebo_sim::Link(link);
    sim::Vector3 c_L = sim::Vector3::Zero();
    if (const auto* inertial = ecm.Component<components::Inertial>(link))
      c_L = ours(inertial->Data().Pose().Pos());
    const gazebo::LinkCoupling::Say line = [this](const std::string& text) { say(text); };
    coupling_.emplace(make_loop(options, c_L, line), line);
    link_.EnableVelocityChecks(ecm);
  }

  static std::unique_ptr<gazebo::LinkLoop> make_loop(const gazebo::PluginOptions& options,
                                                     const sim::Vector3& c_L,
                                                     const gazebo::LinkCoupling::Say& line) {
    if (options.mode == gazebo::PluginOptions::Mode::kWholeLoop)
      return std::make_unique<gazebo::WholeLoop>(
          gazebo::WholeLoop::Options{options.choice, c_L, options.log_file, options.at_end}, line);
    return std::make_unique<DynamicsLoop>(gazebo::open_vehicle(options.choice), options, c_L, line);
  }

  /// Empty until the physics has run.
  std::optional<LinkState> state(const EntityComponentManager& ecm) const {
    const auto pose = link_.WorldPose(ecm);
    const auto v = link_.WorldLinearVelocity(ecm);
    const auto w = link_.WorldAngularVelocity(ecm);
    if (!pose || !v || !w) return std::nullopt;
    const auto& q = pose->Rot();
    return LinkState{ours(pose->Pos()), {q.W(), q.X(), q.Y(), q.Z()}, ours(*v), ours(*w)};
  }

  /// Velocities count in the axes that the model has now, before it is turned.
  void place(const LinkState& link, EntityComponentManager& ecm) {
    const Pose3d model_now = gazebo_sim::worldPose(model_.Entity(), ecm);
    const Pose3d link_in_model = model_now.Inverse() * gazebo_sim::worldPose(link_.Entity(), ecm);
    model_.SetWorldPoseCmd(ecm, pose_of(link) * link_in_model.Inverse());
    const auto& rotation = model_now.Rot();
    ecm.CreateComponent(model_.Entity(), components::LinearVelocityCmd(
                                             rotation.RotateVectorReverse(gazebos(link.v_G))));
    ecm.CreateComponent(model_.Entity(), components::AngularVelocityCmd(
                                             rotation.RotateVectorReverse(gazebos(link.w_G))));
    placed_ = true;
  }

  /// Gazebo 6 and 8 set what is left of a velocity command to zero, and obey it in each later step; a pose is obeyed twice.
  void remove_commands(EntityComponentManager& ecm) {
    if (!std::exchange(placed_, false)) return;
    ecm.RemoveComponent<components::WorldPoseCmd>(model_.Entity());
    ecm.RemoveComponent<components::LinearVelocityCmd>(model_.Entity());
    ecm.RemoveComponent<components::AngularVelocityCmd>(model_.Entity());
  }

  gazebo_sim::EventManager* events_{nullptr};
  gazebo_sim::Model model_;
  gazebo_sim::Link link_;
  std::string name_{"world"};
  bool placed_{false};
  std::optional<BodyClaim> claim_;
  std::optional<gazebo::LinkCoupling> coupling_;  ///< Empty: what is wrong has been reported.
};

}  // namespace rosflight_sim

ROSFLIGHT_ADD_GAZEBO_SYSTEM(rosflight_sim::GazeboPlugin, gazebo_sim::System,
                            rosflight_sim::GazeboPlugin::ISystemConfigure,
                            rosflight_sim::GazeboPlugin::ISystemPreUpdate,
                            rosflight_sim::GazeboPlugin::ISystemPostUpdate)
