// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/engine/meshes.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

#include "flight/gazebo/engine/mesh_indices.hpp"

namespace rosflight::flight::gazebo {
namespace {

using gazebo_common::Mesh;
using gazebo_common::SubMesh;

/// Reads it in a process of its own first: a broken file makes Gazebo's readers crash.
void try_in_a_process(const std::filesystem::path& file, const std::string& where) {
  const pid_t child = ::fork();
  if (child < 0)
    throw std::runtime_error(where + ": cannot start a process to read " + file.string());
  if (child == 0) {
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    gazebo_common::MeshManager::Instance()->Load(file);
    ::_exit(0);
  }
  int status = 0;
  if (::waitpid(child, &status, 0) == child && WIFEXITED(status)) return;
  throw std::runtime_error(where + ": Gazebo's reader crashes on the mesh " + file.string() +
                           " (signal " + std::to_string(WTERMSIG(status)) + ")");
}

/// A copy of a part that dartsim takes.
SubMesh checked(const SubMesh& read, const std::string& which) {
  SubMesh part(read);
  const unsigned indices = part.IndexCount();
  if (part.SubMeshPrimitiveType() != SubMesh::TRIANGLES || indices == 0 || indices % 3 != 0)
    throw std::runtime_error(which + " that is not of triangles");
  for (unsigned k = 0; k < part.VertexCount(); ++k) {
    if (!part.Vertex(k).IsFinite())
      throw std::runtime_error(which + " with a vertex that is not finite");
  }
  for (unsigned k = 0; k < indices; ++k) {
    if (part.Index(k) < 0 || static_cast<unsigned>(part.Index(k)) >= part.VertexCount())
      throw std::runtime_error(which + " with an index " + std::to_string(part.Index(k)) +
                               ", allowed 0 to " + std::to_string(part.VertexCount() - 1));
  }
  // It ignores a part whose vertices have no normals, and then fails. Of what they are it uses nothing.
  while (part.NormalCount() < part.VertexCount()) part.AddNormal(0.0, 0.0, 1.0);
  return part;
}

}  // namespace

std::unique_ptr<Mesh> read_mesh(const sdf::Mesh& shape, const std::filesystem::path& file,
                                const std::string& where) {
  gazebo_common::MeshManager* const manager = gazebo_common::MeshManager::Instance();
  if (!manager->HasMesh(file)) {
    check_mesh_indices(file, where);
    try_in_a_process(file, where);
  }
  const std::string which = where + ": found a mesh " + file.string();
  const Mesh* const read = manager->Load(file);
  if (read == nullptr || read->SubMeshCount() == 0)
    throw std::runtime_error(which + " that Gazebo cannot read, allowed .obj, .stl and .dae");
  auto mesh = std::make_unique<Mesh>();
  for (unsigned k = 0; k < read->SubMeshCount(); ++k) {
    const std::shared_ptr<SubMesh> part = read->SubMeshByIndex(k).lock();
    if (!shape.Submesh().empty() && part->Name() != shape.Submesh()) continue;
    SubMesh taken = checked(*part, which);
    if (!shape.Submesh().empty() && shape.CenterSubmesh()) taken.Center();
    mesh->AddSubMesh(taken);
  }
  if (mesh->SubMeshCount() == 0)
    throw std::runtime_error(which + " without a submesh " + shape.Submesh());
  return mesh;
}

}  // namespace rosflight::flight::gazebo
