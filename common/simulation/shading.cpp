// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/shading.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/parallel.hpp"
#include "simulation/moving_light.hpp"

namespace rf::sim {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;
constexpr float kBodyOpenness = 0.92F;  // of a moving body to ambient light
constexpr float kLobe = 0.85F;          // cosine at the edge of a highlight
constexpr float kSurelyBelow = 0.995F;  // a margin for rounding

/// Linear albedo of a material at a point of a face; `footprint` in metres.
Vector3f albedo(const World& world, const Material& m, const Vector2f& at, const Vector2f& extent,
                float footprint) {
  if (m.texture < 0) return m.tint;
  const Texture& texture = world.textures[static_cast<std::size_t>(m.texture)];
  Vector2f texel_per_metre = Vector2f::Constant(1.0F / m.metres_per_texel);
  if (m.fit) {
    texel_per_metre = {static_cast<float>(texture.width()) / extent.x(),
                       static_cast<float>(texture.height()) / extent.y()};
  }
  const Vector2f uv = at.cwiseProduct(texel_per_metre) + m.offset;
  return m.tint.cwiseProduct(texture.sample(uv.x(), uv.y(), footprint * texel_per_metre.mean()));
}

/// Whether the lamp is surely outside a highlight: every c below is at most (along + r) / (D - r).
bool outsideLobe(const LampLight::Group& lamp, const Vector3f& p_W, const Vector3f& mirrored) {
  const Vector3f d = lamp.centre - p_W;
  const float most = mirrored.dot(d) + lamp.radius;
  return most < 0 || most < kSurelyBelow * kLobe * (d.norm() - lamp.radius);
}

/// The lamps' mirror image: a lobe of some ten degrees about the mirrored ray.
Vector3f highlight(const std::vector<LampLight::Group>& lamps, const Vector3f& p_W,
                   const Vector3f& n_W, const Vector3f& ray_W) {
  const Vector3f mirrored = ray_W - 2 * ray_W.dot(n_W) * n_W;
  Vector3f sum = Vector3f::Zero();
  for (const LampLight::Group& lamp : lamps) {
    if (outsideLobe(lamp, p_W, mirrored)) continue;
    for (const LampLight::Point& point : lamp.points) {
      const float c = mirrored.dot((point.place - p_W).normalized());
      if (c < kLobe) continue;
      float lobe = c * c;
      lobe *= lobe;
      lobe *= lobe;
      lobe *= lobe;
      lobe *= lobe;
      sum += lobe * lobe * point.power;
    }
  }
  return sum / 4.0F;
}

class Shader {
 public:
  Shader(const World& world, const LampLight& lamps, const BakedLight& baked,
         const Raycaster& caster, const SurfaceImage& surface, const MovingLight& moving,
         const SE3& T_WC)
      : world_(world),
        lamps_(lamps),
        baked_(baked),
        caster_(caster),
        surface_(surface),
        moving_(moving),
        R_WC_(T_WC.R().cast<float>()),
        t_WC_(T_WC.t.cast<float>()) {}

  void pixel(int u, int v, Shaded& out) const {
    const int index = surface_.primitive(u, v);
    if (index < 0) return;
    const Primitive& primitive = world_.primitives[static_cast<std::size_t>(index)];
    const ViewedPrimitive& view = caster_.viewed(index);
    const int face = surface_.face(u, v);
    const Material& m = world_.materials[static_cast<std::size_t>(
        primitive.material[static_cast<std::size_t>(face)])];
    const float z = surface_.z(u, v);
    const Vector3f ray = world_.camera.backProject(u, v, 1.0).cast<float>();
    const Vector3f p_P = view.origin + view.R_PC * (z * ray);
    const Vector3f normal_P = surfaceNormal(view.kind, view.half, face, p_P);
    const Vector3f n_W = R_WC_ * (view.R_PC.transpose() * normal_P);
    const Vector3f ray_W = R_WC_ * ray.normalized();
    const float cosine = std::clamp(-n_W.dot(ray_W), 0.0F, 1.0F);
    const float footprint =
        z / static_cast<float>(world_.camera.fx) / std::sqrt(std::max(cosine, 0.1F));
    const Vector2f at = surfaceCoordinates(view.kind, view.half, face, p_P);
    const Vector3f colour =
        albedo(world_, m, at, surfaceExtent(view.kind, view.half, face), footprint);
    const Vector3f incident = incidentLight(primitive, index, face, at, n_W, u, v);
    Vector3f light = colour.cwiseProduct(incident + Vector3f::Constant(m.glow));
    if (m.gloss >= 0.05F) {
      const Vector3f p_W = R_WC_ * (z * ray) + t_WC_;
      light += m.gloss * highlight(lamps_.groups(), p_W, n_W, ray_W);
    }
    out.light(u, v) = light;
    out.cosine(u, v) = cosine;
    out.infrared(u, v) = m.infrared;
    out.body(u, v) = static_cast<std::uint8_t>(primitive.body);
  }

  /// Mean over four rays inside the pixel; a ray's colour is that of the neighbouring pixel which
  /// shows the same face.
  Vector3f smoothed(int u, int v, const Image<Vector3f>& light) const {
    static constexpr std::array<std::array<float, 2>, 4> kRays = {
        {{-0.375F, -0.125F}, {0.125F, -0.375F}, {0.375F, 0.125F}, {-0.125F, 0.375F}}};
    Vector3f sum = Vector3f::Zero();
    for (const auto& [du, dv] : kRays) {
      const float su =
          std::clamp(static_cast<float>(u) + du, 0.0F, static_cast<float>(light.width() - 1));
      const float sv =
          std::clamp(static_cast<float>(v) + dv, 0.0F, static_cast<float>(light.height() - 1));
      const Raycaster::Hit hit = caster_.cast(su, sv);
      sum += colourOf(hit, u, v, light);
    }
    return 0.25F * sum;
  }

  bool onBorder(int u, int v) const {
    const auto differs = [&](int i, int j) {
      return surface_.z.inside(i, j) && (surface_.primitive(i, j) != surface_.primitive(u, v) ||
                                         surface_.face(i, j) != surface_.face(u, v));
    };
    return differs(u + 1, v) || differs(u - 1, v) || differs(u, v + 1) || differs(u, v - 1);
  }

 private:
  Vector3f incidentLight(const Primitive& primitive, int index, int face, const Vector2f& at,
                         const Vector3f& n_W, int u, int v) const {
    if (primitive.body > 0) {
      return moving_.at(u, v) + Vector3f::Constant(kBodyOpenness * ambientLight(n_W));
    }
    const Incident incident = baked_.sample(index, face, at);
    return incident.direct.cwiseProduct(moving_.at(u, v)) + Vector3f::Constant(incident.ambient);
  }

  Vector3f colourOf(const Raycaster::Hit& hit, int u, int v, const Image<Vector3f>& light) const {
    static constexpr std::array<std::array<int, 2>, 9> kNear = {
        {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};
    for (const auto& [du, dv] : kNear) {
      const int i = u + du;
      const int j = v + dv;
      if (!light.inside(i, j)) continue;
      if (surface_.primitive(i, j) == hit.primitive && surface_.face(i, j) == hit.face) {
        return light(i, j);
      }
    }
    return light(u, v);
  }

  const World& world_;
  const LampLight& lamps_;
  const BakedLight& baked_;
  const Raycaster& caster_;
  const SurfaceImage& surface_;
  const MovingLight& moving_;
  Eigen::Matrix3f R_WC_;
  Vector3f t_WC_;
};

}  // namespace

Shaded shade(const World& world, const LampLight& lamps, const BakedLight& baked,
             const Raycaster& caster, const SurfaceImage& surface, std::span<const SE3> T_WB,
             const SE3& T_WC) {
  const Camera& c = world.camera;
  Shaded out{Image<Vector3f>(c.width, c.height, Vector3f::Zero()), Image<float>(c.width, c.height),
             Image<float>(c.width, c.height), Image<std::uint8_t>(c.width, c.height)};
  const MovingLight moving(world, lamps, caster, surface, T_WB, T_WC);
  const Shader shader(world, lamps, baked, caster, surface, moving, T_WC);
  parallelRows(c.height, [&](int v) {
    for (int u = 0; u < c.width; ++u) shader.pixel(u, v, out);
  });
  Image<Vector3f> light = out.light;
  parallelRows(c.height, [&](int v) {
    for (int u = 0; u < c.width; ++u) {
      if (shader.onBorder(u, v)) light(u, v) = shader.smoothed(u, v, out.light);
    }
  });
  out.light = std::move(light);
  return out;
}

}  // namespace rf::sim
