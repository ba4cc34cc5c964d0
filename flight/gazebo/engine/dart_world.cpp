// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/engine/dart_world.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "flight/gazebo/engine/gazebo_libraries.hpp"
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
constexpr const char* kGear = "contact_";  // what vehicle_sdf() names its shapes of the gear

Vector3d vector(const Triple& at) {
  return Eigen::Map<const Vector3d>(at.data());
}

void put(const Vector3d& v, Triple& at) {
  Eigen::Map<Vector3d>(at.data()) = v;
}

EnginePtr load_engine(gazebo_plugin::Loader& loader) {
  if (!std::filesystem::exists(kDartLibrary))
    throw std::runtime_error(std::string("found no ") + kDartLibrary +
                             ", which Gazebo's engine dartsim is in");
  loader.LoadLib(kDartLibrary);
  const gazebo_plugin::PluginPtr plugin = loader.Instantiate(kDartPlugin);
  EnginePtr engine;
  if (plugin) engine = physics::RequestEngine<Policy, Features>::From(plugin);
  if (!engine)
    throw std::runtime_error(std::string(kDartLibrary) + ": has no engine with what is needed");
  return engine;
}

Eigen::Isometry3d isometry(const gazebo_math::Pose3d& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translation() = Vector3d(pose.Pos().X(), pose.Pos().Y(), pose.Pos().Z());
  const auto& q = pose.Rot();
  out.linear() = Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).toRotationMatrix();
  return out;
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

  /// The engine makes no mesh from SDF by itself: each is read and attached.
  void add_meshes(const sdf::Model& model, const std::filesystem::path& world_file);
  void add_mesh(const LinkPtr& link, const sdf::Collision& collision,
                const std::filesystem::path& folder, const std::string& where) const;
};

void DartWorld::Scene::add_mesh(const LinkPtr& link, const sdf::Collision& collision,
                                const std::filesystem::path& folder,
                                const std::string& where) const {
  const sdf::Mesh& shape = *collision.Geom()->MeshShape();
  const std::string file = find_file(shape.Uri(), folder);
  const gazebo_common::Mesh* read =
      file.empty() ? nullptr : gazebo_common::MeshManager::Instance()->Load(file);
  if (read == nullptr)
    throw std::runtime_error(where + ": found no mesh " + shape.Uri() + " that can be read");
  // dartsim ignores a part whose vertices have no normals, and then fails: it gets a copy that has them.
  gazebo_common::Mesh mesh;
  for (unsigned k = 0; k < read->SubMeshCount(); ++k) {
    gazebo_common::SubMesh part(*read->SubMeshByIndex(k).lock());
    if (part.SubMeshPrimitiveType() != gazebo_common::SubMesh::TRIANGLES ||
        part.IndexCount() == 0 || part.IndexCount() % 3 != 0)
      throw std::runtime_error(where + ": found a mesh " + shape.Uri() +
                               " that is not of triangles");
    while (part.NormalCount() < part.VertexCount()) part.AddNormal(0.0, 0.0, 1.0);
    part.RecalculateNormals();
    mesh.AddSubMesh(part);
  }
  gazebo_math::Pose3d pose;
  if (!collision.SemanticPose().Resolve(pose).empty()) pose = collision.RawPose();
  link->AttachMeshShape(collision.Name(), mesh, isometry(pose),
                        {shape.Scale().X(), shape.Scale().Y(), shape.Scale().Z()});
}

void DartWorld::Scene::add_meshes(const sdf::Model& model,
                                  const std::filesystem::path& world_file) {
  for (std::uint64_t l = 0; l < model.LinkCount(); ++l) {
    const sdf::Link& link = *model.LinkByIndex(l);
    for (std::uint64_t c = 0; c < link.CollisionCount(); ++c) {
      const sdf::Collision& collision = *link.CollisionByIndex(c);
      const sdf::GeometryType type = collision.Geom()->Type();
      const std::string where =
          world_file.string() + ": " + model.Name() + "::" + link.Name() + "::" + collision.Name();
      if (type == sdf::GeometryType::MESH) {
        const ModelPtr made = world->GetModel(model.Name());
        const LinkPtr made_link = made ? made->GetLink(link.Name()) : LinkPtr{};
        if (!made_link) throw std::runtime_error(where + ": its link was not made");
        add_mesh(made_link, collision, world_file.parent_path(), where);
      } else if (type == sdf::GeometryType::HEIGHTMAP) {
        throw std::runtime_error(
            "collision " + where +
            ": found a shape that dartsim does not read from SDF, allowed box, "
            "capsule, cylinder, ellipsoid, mesh, plane, sphere");
      }
    }
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
  const sdf::Root root = world_file.empty() ? read_sdf_text(kEmptyWorld) : read_sdf(world_file);
  if (root.WorldCount() != 1)
    throw std::runtime_error(world_file.string() + ": found " + std::to_string(root.WorldCount()) +
                             " worlds, allowed 1");
  const sdf::World& world = *root.WorldByIndex(0);
  if (world.ModelNameExists(model.Model()->Name()))
    throw std::runtime_error(world_file.string() + ": found a model " + model.Model()->Name() +
                             ", the name of the vehicle");
  scene_->engine = load_engine(scene_->loader);
  scene_->world = scene_->engine->ConstructWorld(world);
  if (!scene_->world)
    throw std::runtime_error(world_file.string() + ": dartsim makes no world of it");
  for (std::uint64_t k = 0; k < world.ModelCount(); ++k)
    scene_->add_meshes(*world.ModelByIndex(k), world_file);
  scene_->world->SetGravity(Vector3d(0.0, 0.0, -gravity_m_s2));
  const ModelPtr vehicle = scene_->world->ConstructModel(*model.Model());
  if (vehicle) scene_->body = vehicle->GetLink(kBodyLink);
  if (!scene_->body) throw std::runtime_error("dartsim makes no vehicle of its SDF");
  scene_->body_id = scene_->body->EntityID();
}

DartWorld::~DartWorld() = default;

void DartWorld::set_state(const Block& block) {
  const auto group = scene_->body->FindFreeGroup();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = vector(block.p_G);
  pose.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(block.R_GL.data());
  group->SetWorldPose(pose);
  group->SetWorldAngularVelocity(vector(block.w_G));
  group->SetWorldLinearVelocity(vector(block.v_G));
}

void DartWorld::check_place() {
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
                               std::to_string(std::abs(extra->depth)).substr(0, 4) + " m deep");
    }
  }
}

void DartWorld::move(Block& block) {
  Scene& scene = *scene_;
  const auto before = scene.body->FrameDataRelativeToWorld();
  const Vector3d centre = before.pose.translation();
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
    const Vector3d v = before.linearVelocity + before.angularVelocity.cross(arm);
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
