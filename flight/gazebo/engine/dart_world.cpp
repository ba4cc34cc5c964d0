// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/engine/dart_world.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <vector>

#include "flight/gazebo/engine/gazebo_libraries.hpp"
#include "flight/gazebo/engine/ground_below.hpp"
#include "flight/gazebo/engine/meshes.hpp"
#include "flight/gazebo/engine/sdf_files.hpp"

namespace rosflight::flight::gazebo {
namespace {

namespace physics = gazebo_physics;
using Eigen::Vector3d;
using Features =
    physics::FeatureList<physics::GetEntities, physics::LinkFrameSemantics,
                         physics::FindFreeGroupFeature, physics::SetFreeGroupWorldPose,
                         physics::SetFreeGroupWorldVelocity, physics::AddLinkExternalForceTorque,
                         physics::ForwardStep, physics::GetContactsFromLastStepFeature,
                         physics::Gravity, physics::mesh::AttachMeshShapeFeature,
                         physics::sdf::ConstructSdfWorld, physics::sdf::ConstructSdfModel,
                         physics::sdf::ConstructSdfLink, physics::sdf::ConstructSdfCollision>;
using Policy = physics::FeaturePolicy3d;
using EnginePtr = physics::EnginePtr<Policy, Features>;
using WorldPtr = physics::WorldPtr<Policy, Features>;
using ModelPtr = physics::ModelPtr<Policy, Features>;
using LinkPtr = physics::LinkPtr<Policy, Features>;
using World = physics::World<Policy, Features>;

constexpr const char* kBodyLink = "base_link";
constexpr double kHalfPlane_m = 1050.0;    // dartsim's plane is a cube of 2100 m
constexpr const char* kGear = "contact_";  // what vehicle_sdf() names its shapes of the gear

Vector3d vector(const Triple& at) {
  return Eigen::Map<const Vector3d>(at.data());
}

void put(const Vector3d& v, Triple& at) {
  Eigen::Map<Vector3d>(at.data()) = v;
}

EnginePtr load_engine(gazebo_plugin::Loader& loader) {
  const std::string library = dart_library();
  if (!std::filesystem::exists(library))
    throw std::runtime_error("found no " + library + ", Gazebo's engine dartsim; install " +
                             kDartPackage);
  loader.LoadLib(library);
  const gazebo_plugin::PluginPtr plugin = loader.Instantiate(kDartPlugin);
  EnginePtr engine;
  if (plugin) engine = physics::RequestEngine<Policy, Features>::From(plugin);
  if (!engine) throw std::runtime_error(library + ": has no engine with what is needed");
  return engine;
}

std::string metres(double length_m) {
  const std::string text = std::to_string(length_m);
  return text.substr(0, text.find('.') + 3) + " m";
}

Eigen::Isometry3d isometry(const gazebo_math::Pose3d& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translation() = Vector3d(pose.Pos().X(), pose.Pos().Y(), pose.Pos().Z());
  const auto& q = pose.Rot();
  out.linear() = Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).toRotationMatrix();
  return out;
}

/// In Gazebo all of a static model is static; dartsim takes each nested one for itself.
void pass_on_static(const sdf::Model& model) {
  for (std::uint64_t k = 0; k < model.ModelCount(); ++k) {
    // sdformat 12 gives out constant models alone, of a root that is ours to change.
    sdf::Model& nested = const_cast<sdf::Model&>(*model.ModelByIndex(k));
    if (model.Static()) nested.SetStatic(true);
    pass_on_static(nested);
  }
}

struct PlacedBox {
  Eigen::Isometry3d pose{Eigen::Isometry3d::Identity()};
  Vector3d half{Vector3d::Zero()};
};

/// The box around a shape that dartsim makes from SDF by itself; a plane is made as a box below it. nullopt: it makes none.
std::optional<PlacedBox> box_around(const sdf::Geometry& shape) {
  PlacedBox out;
  switch (shape.Type()) {
    case sdf::GeometryType::BOX: {
      const auto size = shape.BoxShape()->Size();
      out.half = 0.5 * Vector3d(size.X(), size.Y(), size.Z());
      return out;
    }
    case sdf::GeometryType::SPHERE:
      out.half.setConstant(shape.SphereShape()->Radius());
      return out;
    case sdf::GeometryType::CYLINDER: {
      const double r_m = shape.CylinderShape()->Radius();
      out.half = {r_m, r_m, 0.5 * shape.CylinderShape()->Length()};
      return out;
    }
    case sdf::GeometryType::CAPSULE: {
      const double r_m = shape.CapsuleShape()->Radius();
      out.half = {r_m, r_m, 0.5 * shape.CapsuleShape()->Length() + r_m};
      return out;
    }
    case sdf::GeometryType::ELLIPSOID: {
      const auto radii = shape.EllipsoidShape()->Radii();
      out.half = {radii.X(), radii.Y(), radii.Z()};
      return out;
    }
    case sdf::GeometryType::PLANE: {
      const auto n = shape.PlaneShape()->Normal();
      out.half.setConstant(kHalfPlane_m);
      out.pose.linear() =
          Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d(n.X(), n.Y(), n.Z()))
              .toRotationMatrix();
      out.pose.translation() = -kHalfPlane_m * out.pose.linear().col(2);
      return out;
    }
    default:
      return std::nullopt;
  }
}

}  // namespace

struct DartWorld::Scene {
  gazebo_plugin::Loader loader;
  EnginePtr engine;
  WorldPtr world;
  LinkPtr body;
  std::size_t body_id{};
  physics::ForwardStep::Output output;
  physics::ForwardStep::State state;
  physics::ForwardStep::Input input;

  void step(double step_s) {
    input.Get<std::chrono::steady_clock::duration>() =
        std::chrono::nanoseconds(std::llround(step_s * 1e9));
    world->Step(output, state, input);
  }

  /// Makes what the engine does not make from SDF, the meshes, and notes where each shape is.
  void add_shapes(const ModelPtr& made, const sdf::Model& model, const std::string& where);
  void add_shape(const LinkPtr& link, const sdf::Collision& collision, const std::string& where);
  void add_mesh(const LinkPtr& link, const sdf::Collision& collision, const Eigen::Isometry3d& pose,
                const std::string& where);

  std::filesystem::path folder;  ///< The folder of the world file.
  std::vector<std::string> files;
  GroundBelow ground;
};

void DartWorld::Scene::add_mesh(const LinkPtr& link, const sdf::Collision& collision,
                                const Eigen::Isometry3d& pose, const std::string& where) {
  const sdf::Mesh& shape = *collision.Geom()->MeshShape();
  const std::filesystem::path own = std::filesystem::path(shape.FilePath()).parent_path();
  const std::string file = find_file(shape.Uri(), {own, own / "..", folder});
  if (file.empty()) throw std::runtime_error(where + ": found no mesh " + shape.Uri());
  const auto mesh = read_mesh(shape, file, where);
  files.push_back(file);
  const Vector3d scale(shape.Scale().X(), shape.Scale().Y(), shape.Scale().Z());
  const std::string model = link->GetModel()->GetName();
  const Eigen::Isometry3d in_world = link->FrameDataRelativeToWorld().pose * pose;
  for (unsigned k = 0; k < mesh->SubMeshCount(); ++k) {
    const auto part = mesh->SubMeshByIndex(k).lock();
    const auto corner = [&](unsigned index) -> Vector3d {
      const auto v = part->Vertex(static_cast<unsigned>(part->Index(index)));
      return in_world * Vector3d(v.X(), v.Y(), v.Z()).cwiseProduct(scale);
    };
    for (unsigned i = 0; i + 2 < part->IndexCount(); i += 3)
      ground.add_triangle(model, {corner(i), corner(i + 1), corner(i + 2)});
  }
  link->AttachMeshShape(collision.Name(), *mesh, pose, scale);
}

void DartWorld::Scene::add_shape(const LinkPtr& link, const sdf::Collision& collision,
                                 const std::string& where) {
  gazebo_math::Pose3d given;
  if (!collision.SemanticPose().Resolve(given).empty()) given = collision.RawPose();
  const Eigen::Isometry3d pose = isometry(given);
  const sdf::Geometry& shape = *collision.Geom();
  if (shape.Type() == sdf::GeometryType::MESH) return add_mesh(link, collision, pose, where);
  const std::optional<PlacedBox> box = box_around(shape);
  if (!box)
    throw std::runtime_error("collision " + where +
                             ": found a shape that dartsim does not read from SDF, allowed box, "
                             "capsule, cylinder, ellipsoid, mesh, plane, sphere");
  ground.add_box(link->GetModel()->GetName(),
                 link->FrameDataRelativeToWorld().pose * pose * box->pose, box->half);
}

void DartWorld::Scene::add_shapes(const ModelPtr& made, const sdf::Model& model,
                                  const std::string& where) {
  const std::string name = where + model.Name() + "::";
  if (!made) throw std::runtime_error(name + ": was not made by dartsim");
  if (model.Element()) files.push_back(model.Element()->FilePath());
  for (std::uint64_t l = 0; l < model.LinkCount(); ++l) {
    const sdf::Link& link = *model.LinkByIndex(l);
    const LinkPtr made_link = made->GetLink(link.Name());
    if (!made_link) throw std::runtime_error(name + link.Name() + ": was not made by dartsim");
    for (std::uint64_t c = 0; c < link.CollisionCount(); ++c) {
      const sdf::Collision& collision = *link.CollisionByIndex(c);
      add_shape(made_link, collision, name + link.Name() + "::" + collision.Name());
    }
  }
  for (std::uint64_t k = 0; k < model.ModelCount(); ++k) {
    const sdf::Model& nested = *model.ModelByIndex(k);
    add_shapes(made->GetNestedModel(nested.Name()), nested, name);
  }
}

DartWorld::DartWorld(const std::string& model_sdf, const std::filesystem::path& world_file,
                     double gravity_m_s2)
    : scene_{std::make_unique<Scene>()} {
  gazebo_common::Console::SetVerbosity(0);
  const sdf::Root model = read_sdf_text(model_sdf);
  if (model.Model() == nullptr || !model.Model()->LinkNameExists(kBodyLink))
    throw std::runtime_error(std::string("the vehicle's SDF has no model with a link ") +
                             kBodyLink);
  sdf::Root root = world_file.empty() ? read_sdf_text(kEmptyWorld) : read_sdf(world_file);
  if (root.WorldCount() != 1)
    throw std::runtime_error(world_file.string() + ": found " + std::to_string(root.WorldCount()) +
                             " worlds, allowed 1");
  const sdf::World& world = *root.WorldByIndex(0);
  if (world.ModelNameExists(model.Model()->Name()))
    throw std::runtime_error(world_file.string() + ": found a model " + model.Model()->Name() +
                             ", the name of the vehicle");
  for (std::uint64_t k = 0; k < world.ModelCount(); ++k) pass_on_static(*world.ModelByIndex(k));
  scene_->engine = load_engine(scene_->loader);
  scene_->world = scene_->engine->ConstructWorld(world);
  if (!scene_->world)
    throw std::runtime_error(world_file.string() + ": dartsim makes no world of it");
  scene_->folder = world_file.parent_path();
  if (!world_file.empty()) scene_->files.push_back(world_file);
  for (std::uint64_t k = 0; k < world.ModelCount(); ++k) {
    const sdf::Model& other = *world.ModelByIndex(k);
    scene_->add_shapes(scene_->world->GetModel(other.Name()), other, world_file.string() + ": ");
  }
  scene_->world->SetGravity(Vector3d(0.0, 0.0, -gravity_m_s2));
  const ModelPtr vehicle = scene_->world->ConstructModel(*model.Model());
  if (vehicle) scene_->body = vehicle->GetLink(kBodyLink);
  if (!scene_->body) throw std::runtime_error("dartsim makes no vehicle of its SDF");
  scene_->body_id = scene_->body->EntityID();
}

DartWorld::~DartWorld() = default;

std::vector<std::string> DartWorld::files() const {
  std::vector<std::string> out;
  for (const std::string& file : scene_->files)
    if (!file.empty() && std::find(out.begin(), out.end(), file) == out.end()) out.push_back(file);
  return out;
}

void DartWorld::set_state(const Block& block) {
  const auto group = scene_->body->FindFreeGroup();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = vector(block.p_G);
  pose.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(block.R_GL.data());
  group->SetWorldPose(pose);
  group->SetWorldAngularVelocity(vector(block.w_G));
  group->SetWorldLinearVelocity(vector(block.v_G));
}

void DartWorld::check_place(const Block& block) {
  const Vector3d start = vector(block.p_G);
  const auto below = scene_->ground.below(start);
  if (!below) {
    const auto above = scene_->ground.above(start);
    throw std::runtime_error(
        "the world has no ground below the vehicle at its start" +
        (above ? "; " + above->model + " is " + metres(above->distance_m) + " above it" : ""));
  }
  if (below->distance_m > block.max_height_m)
    throw std::runtime_error("the vehicle starts " + metres(below->distance_m) + " above " +
                             below->model + " of the world, allowed " + metres(block.max_height_m));
  // Contacts are found in a step only; this one is too short to move anything.
  scene_->step(1e-9);
  for (const auto& contact : scene_->world->GetContactsFromLastStep()) {
    const auto& point = contact.Get<World::ContactPoint>();
    const auto* extra = contact.Query<World::ExtraContactData>();
    const auto first = point.collision1->GetLink();
    const auto second = point.collision2->GetLink();
    const bool ours = first->EntityID() == scene_->body_id;
    if (!ours && second->EntityID() != scene_->body_id) continue;
    if (extra != nullptr && std::abs(extra->depth) > kMaxOverlap_m) {
      throw std::runtime_error("the vehicle is inside " +
                               (ours ? second : first)->GetModel()->GetName() + " of the world, " +
                               metres(std::abs(extra->depth)) + " deep");
    }
  }
}

void DartWorld::move(Block& block) {
  Scene& scene = *scene_;
  const Vector3d centre = vector(block.p_G);  // as the step before left it
  const Vector3d centre_v = vector(block.v_G);
  const Vector3d w = vector(block.w_G);
  scene.body->AddExternalForce(vector(block.force_G));
  scene.body->AddExternalTorque(vector(block.torque_G));
  scene.step(block.step_s);

  Vector3d force = Vector3d::Zero();
  Vector3d torque = Vector3d::Zero();
  block.touches = block.airframe_touches = block.carries = 0;
  block.approach_m_s = block.normal_up = 0.0;
  block.other.fill('\0');
  for (const auto& contact : scene.world->GetContactsFromLastStep()) {
    const auto& point = contact.Get<World::ContactPoint>();
    const auto* extra = contact.Query<World::ExtraContactData>();
    const auto first = point.collision1->GetLink();
    const auto second = point.collision2->GetLink();
    const bool ours = first->EntityID() == scene.body_id;
    if ((!ours && second->EntityID() != scene.body_id) || extra == nullptr) continue;
    const double sign = ours ? 1.0 : -1.0;
    const Vector3d arm = point.point - centre;
    force += sign * extra->force;
    torque += sign * arm.cross(extra->force);
    const Vector3d v = centre_v + w.cross(arm);
    const double approach = -sign * v.dot(extra->normal);
    if (block.touches == 0 || approach > block.approach_m_s) {
      block.approach_m_s = std::max(approach, 0.0);
      block.normal_up = sign * extra->normal.z();
      const std::string other = (ours ? second : first)->GetModel()->GetName();
      block.other.fill('\0');
      std::copy_n(other.begin(), std::min(other.size(), block.other.size() - 1),
                  block.other.begin());
    }
    block.touches = 1;
    if (sign * extra->normal.z() >= kSteep) block.carries = 1;
    const std::string& shape = (ours ? point.collision1 : point.collision2)->GetName();
    if (!shape.starts_with(kGear)) block.airframe_touches = 1;
  }
  put(force, block.contact_force_G);
  put(torque, block.contact_torque_G);
  read_state(block);
}

void DartWorld::read_state(Block& block) const {
  const auto now = scene_->body->FrameDataRelativeToWorld();
  put(now.pose.translation(), block.p_G);
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(block.R_GL.data()) = now.pose.linear();
  put(now.linearVelocity, block.v_G);
  put(now.angularVelocity, block.w_G);
}

}  // namespace rosflight::flight::gazebo
