// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/mesh_file.h"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/own_process.h"
#include "framework/geometry/mesh_doubts.h"
#include "framework/geometry/mesh_readers.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = std::size_t{1} << 30;  // bytes

struct Format {
  const char* extension;
  const char* name;
};
constexpr Format kFormats[] = {{".obj", "Wavefront OBJ"}, {".ply", "PLY"},  {".stl", "STL"},
                               {".gltf", "glTF"},         {".glb", "glTF"}, {".dae", "Collada"}};

std::string format_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Format& format : kFormats)
    if (extension == format.extension) return format.name;
  throw InputError(
      "'" + path.string() +
      "' is not a mesh file that can be read: expected .obj, .ply, .stl, .gltf, .glb or "
      ".dae");
}

// What the file, its standard or the caller says of unit and axis.
void settle_frame(const std::string& text, const MeshFileOptions& options, MeshFile& file) {
  if (file.format == "Collada") {
    const ColladaFrame stated = collada_frame(text);
    file.unit = stated.unit.value_or(1.0);
    file.unit_from = stated.unit ? StatedBy::file : StatedBy::standard;
    file.up = stated.up.value_or(UpAxis::y);
    file.up_from = stated.up ? StatedBy::file : StatedBy::standard;
  } else if (file.format == "glTF") {
    file.up = UpAxis::y;
    file.unit_from = file.up_from = StatedBy::standard;
  }
  if (options.unit) file.unit = *options.unit, file.unit_from = StatedBy::caller;
  if (options.up) file.up = *options.up, file.up_from = StatedBy::caller;
}

Eigen::Vector3d z_up(const Eigen::Vector3d& p, UpAxis up) {
  switch (up) {
    case UpAxis::x:
      return {-p.z(), p.y(), p.x()};
    case UpAxis::y:
      return {p.x(), -p.z(), p.y()};
    case UpAxis::z:
      break;
  }
  return p;
}

Rgb color_of(const aiScene& scene, const aiMesh& mesh) {
  aiColor3D color(0.7f, 0.7f, 0.7f);
  if (mesh.mMaterialIndex < scene.mNumMaterials) {
    scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_COLOR_DIFFUSE, color);
  }
  const auto byte = [](float v) {
    return static_cast<std::uint8_t>(std::isfinite(v) ? std::lround(255 * std::clamp(v, 0.f, 1.f))
                                                      : 0);
  };
  return {byte(color.r), byte(color.g), byte(color.b)};
}

class Gatherer {
 public:
  Gatherer(const aiScene& scene, const MeshFile& frame, const std::string& name)
      : scene_(scene), frame_(frame), name_(name) {}

  TriangleMesh gather() {
    if (scene_.mRootNode) visit(*scene_.mRootNode, aiMatrix4x4(), 0);
    return std::move(mesh_);
  }

 private:
  void visit(const aiNode& node, const aiMatrix4x4& parent, int depth) {
    if (depth > 500) throw InputError("'" + name_ + "': nodes are nested deeper than 500");
    const aiMatrix4x4 to_world = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      if (node.mMeshes[i] < scene_.mNumMeshes) add(*scene_.mMeshes[node.mMeshes[i]], to_world);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      visit(*node.mChildren[i], to_world, depth + 1);
    }
  }

  void add(const aiMesh& part, const aiMatrix4x4& to_world) {
    const std::size_t first = mesh_.vertices.size();
    // A node may name one mesh many times: files that unfold to more than fits are refused early.
    if (first + part.mNumVertices > 100'000'000) {
      throw InputError("'" + name_ + "': more than 100 million vertices");
    }
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D v = to_world * part.mVertices[i];
      mesh_.vertices.push_back(frame_.unit * z_up({v.x, v.y, v.z}, frame_.up));
    }
    const Rgb color = color_of(scene_, part);
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      std::vector<std::int32_t> corners;
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        const bool known = face.mIndices[k] < part.mNumVertices;
        corners.push_back(known ? static_cast<std::int32_t>(first + face.mIndices[k]) : -1);
      }
      append_polygon(corners, color, mesh_);
    }
  }

  const aiScene& scene_;
  const MeshFile& frame_;
  const std::string& name_;
  TriangleMesh mesh_;
};

void configure(Assimp::Importer& importer) {
  // Unit and axis are applied here, once, from what the file states.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                  aiComponent_COLORS | aiComponent_TEXCOORDS |
                                  aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                  aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS);
}

const char* words(StatedBy by) {
  switch (by) {
    case StatedBy::file:
      return "stated by the file";
    case StatedBy::standard:
      return "by the format's standard";
    case StatedBy::caller:
      return "as asked for";
    case StatedBy::assumption:
      break;
  }
  return "assumed";
}

}  // namespace

UpAxis up_axis(const std::string& name) {
  if (name != "x" && name != "y" && name != "z")
    throw InputError("up: expected x, y or z, got '" + name + "'");
  return name == "x" ? UpAxis::x : name == "y" ? UpAxis::y : UpAxis::z;
}

std::string MeshFile::description() const {
  char unit_text[32];
  std::snprintf(unit_text, sizeof unit_text, "%.6g", unit);
  const char* axis = up == UpAxis::x ? "x" : up == UpAxis::y ? "y" : "z";
  return format + ", " + unit_text + " m a unit (" + words(unit_from) + "), " + axis + " up (" +
         words(up_from) + "), " + std::to_string(mesh.triangles.size()) + " triangles";
}

namespace {

TriangleMesh gathered(const MeshFile& file, const std::string& bytes, const std::string& name) {
  Assimp::Importer importer;
  configure(importer);
  const aiScene* scene = importer.ReadFile(name, aiProcess_RemoveComponent);
  if (!scene || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE)) {
    const std::string why = importer.GetErrorString();
    throw InputError("'" + name + "' cannot be read as " + file.format +
                     (why.empty() ? ": it holds no mesh" : ": " + why));
  }
  MeshFile frame;
  frame.unit = file.unit;
  frame.up = file.up;
  // The Collada reader has applied the unit that the file states.
  if (file.format == "Collada") frame.unit /= collada_frame(bytes).unit.value_or(1.0);
  return Gatherer(*scene, frame, name).gather();
}

template <class Number>
void append(const std::vector<Number>& numbers, std::string& bytes) {
  const std::uint64_t count = numbers.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(numbers.data()), count * sizeof(Number));
}

template <class Number>
void take(std::string_view& bytes, std::vector<Number>& numbers) {
  std::uint64_t count = 0;
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes.remove_prefix(sizeof count);
  numbers.resize(count);
  if (count > 0)  // an empty vector has no address to copy to
    std::memcpy(static_cast<void*>(numbers.data()), bytes.data(), count * sizeof(Number));
  bytes.remove_prefix(count * sizeof(Number));
}

// In a process of its own: files that are wrong in the right way end assimp by its own assertions,
// by a crash, or not at all.
TriangleMesh read_by_assimp(const MeshFile& file, const std::string& bytes,
                            const std::string& name) {
  const std::string result = in_own_process("'" + name + "' as " + file.format, {}, [&] {
    ::close(STDERR_FILENO);  // what assimp prints as it ends
    const TriangleMesh mesh = gathered(file, bytes, name);
    std::string packed;
    append(mesh.vertices, packed);
    append(mesh.triangles, packed);
    append(mesh.colors, packed);
    return packed;
  });
  TriangleMesh mesh;
  std::string_view rest = result;
  take(rest, mesh.vertices);
  take(rest, mesh.triangles);
  take(rest, mesh.colors);
  return mesh;
}

}  // namespace

MeshFile read_mesh(const fs::path& path, const MeshFileOptions& options) {
  const std::string name = path.string();
  MeshFile file;
  file.format = format_of(path);
  if (options.unit && !(*options.unit > 0 && std::isfinite(*options.unit))) {
    throw InputError("'" + name + "': the unit must be above 0 m");
  }
  const std::string bytes = read_file(path, kLargestFile);
  if (bytes.empty()) throw InputError("'" + name + "': it is empty");
  settle_frame(bytes, options, file);
  if (file.format == "PLY") {
    file.mesh = read_ply(bytes, name);
    for (Eigen::Vector3d& v : file.mesh.vertices) v = file.unit * z_up(v, file.up);
  } else {
    if (file.format == "STL") check_stl(bytes, name);
    if (file.format == "glTF") check_gltf(bytes, name);
    if (file.format == "Collada") check_collada(bytes, name);
    file.mesh = read_by_assimp(file, bytes, name);
  }
  require_near(file, "'" + name + "'");
  check_mesh(file.mesh, "'" + name + "'");
  const std::size_t before = file.mesh.triangles.size();
  weld(file.mesh, 0);
  file.dropped = before - file.mesh.triangles.size();
  if (file.mesh.triangles.empty()) {
    throw InputError("'" + name + "': none of its " + std::to_string(before) +
                     " triangles has an area");
  }
  file.doubt = doubt_of(file);
  return file;
}

std::string ply_bytes(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh to be written");
  const bool colored = !mesh.colors.empty();
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment metres, z up\nelement vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\n" +
      (colored ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "") +
      "end_header\n";
  static_assert(std::endian::native == std::endian::little);
  const auto append = [&bytes](const auto& number) {
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    bytes.append(raw, sizeof number);
  };
  bytes.reserve(bytes.size() + 12 * mesh.vertices.size() + 16 * mesh.triangles.size());
  for (const Eigen::Vector3d& v : mesh.vertices) {
    for (int i = 0; i < 3; ++i) append(static_cast<float>(v[i]));
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    bytes.push_back(3);
    for (const std::int32_t index : mesh.triangles[i]) append(index);
    if (!colored) continue;
    for (const std::uint8_t part : mesh.colors[i]) bytes.push_back(static_cast<char>(part));
  }
  return bytes;
}

void write_ply(const TriangleMesh& mesh, const fs::path& path) {
  write_file_atomically(path, ply_bytes(mesh));
}

}  // namespace lapwing
