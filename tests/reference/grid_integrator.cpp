#include "tests/reference/grid_integrator.h"

#include "tests/reference/curve.h"
#include "tests/reference/grid_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace tetravox::reference {
namespace {

/// A ray in lattice coordinates: origin + t * direction, t in world lengths.
struct LatticeRay {
  Vec origin{}, direction{};

  Vec at(double t) const { return origin + t * direction; }
};

LatticeRay make_lattice_ray(const Lattice& lattice, const Screen& screen, const CameraAxes& axes, int i, int j) {
  const Ray ray = screen.ray(i, j);
  const Vec start = axes.world_from_camera(ray.origin) + (screen.view.camera.position - lattice.origin);
  return {lattice.to_lattice(start), lattice.to_lattice(axes.world_from_camera(unit(ray.direction)))};
}

/// Depths at which a ray passes from cell to cell, from the first it is in to the end of the last; ascending.
std::vector<double> find_borders(const Lattice& lattice, const LatticeRay& ray) {
  double near = 0.0, far = std::numeric_limits<double>::infinity();
  std::vector<double> depths;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& knots = lattice.knots[axis];
    if (knots.size() < 2) return {};
    if (ray.direction[axis] == 0.0) {
      if (ray.origin[axis] < knots.front() || ray.origin[axis] > knots.back()) return {};
      continue;
    }
    for (const double knot : knots) depths.push_back((knot - ray.origin[axis]) / ray.direction[axis]);
    const double first = *(depths.end() - static_cast<std::ptrdiff_t>(knots.size())), last = depths.back();
    near = std::max(near, std::min(first, last));
    far = std::min(far, std::max(first, last));
  }
  if (!(far > near)) return {};
  depths.push_back(near);
  depths.push_back(far);
  std::erase_if(depths, [&](double t) { return t < near || t > far; });
  std::sort(depths.begin(), depths.end());
  depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
  return depths;
}

CellIndex find_cell(const Lattice& lattice, const Vec& place) {
  CellIndex cell;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& knots = lattice.knots[axis];
    const auto above = std::upper_bound(knots.begin(), knots.end(), place[axis]) - knots.begin();
    cell[axis] = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(above - 1, 0, static_cast<std::ptrdiff_t>(knots.size()) - 2));
  }
  return cell;
}

/// The part of a ray inside one cell: fractions of the cell at both ends.
struct CellChord {
  Vec front{}, back{};
  double length = 0.0;

  Vec at(double u) const {
    Vec place = front + u * (back - front);
    for (double& x : place) x = std::clamp(x, 0.0, 1.0);
    return place;
  }
  std::array<CellChord, 2> split() const {
    const Vec middle = at(0.5);
    return {{{front, middle, 0.5 * length}, {middle, back, 0.5 * length}}};
  }
};

CellChord make_chord(const Lattice& lattice, const CellIndex& cell, const Vec& front, const Vec& back, double length) {
  CellChord chord{{}, {}, length};
  for (int axis = 0; axis < 3; ++axis) {
    const double low = lattice.knots[axis][cell[axis]], high = lattice.knots[axis][cell[axis] + 1];
    chord.front[axis] = (front[axis] - low) / (high - low);
    chord.back[axis] = (back[axis] - low) / (high - low);
  }
  return chord;
}

/// The field along a chord.
Curve make_curve(const Lattice& lattice, const CellField& field, const CellChord& chord) {
  const int degree = lattice.is_constant || lattice.filter.kind == FilterKind::kLinear ? 3 : 9;
  Curve curve;
  curve.degree = degree;
  if (field.is_flat()) {
    curve.bernstein.fill(field.low());
    return curve;
  }
  std::array<double, kLargestDegree + 1> samples;
  for (int i = 0; i <= degree; ++i) samples[i] = field.eval(chord.at(sample_place(degree, i)));
  return fit_curve(degree, samples.data());
}

/// Whether the curve is the field to within 1e-10 of the cell's range: false only for kernels that are no polynomials.
bool is_faithful(const CellField& field, const CellChord& chord, const Curve& curve) {
  for (const double u : {0.013, 0.21, 0.57, 0.93})
    if (std::abs(curve.eval(u) - field.eval(chord.at(u))) > 1e-10 * (field.high() - field.low())) return false;
  return true;
}

class RayDrawer {
 public:
  RayDrawer(const Lattice& lattice, const std::vector<std::vector<double>>& channels, const OpticalFunction& function,
            int pieces)
      : lattice_(lattice),
        channels_(channels),
        function_(function),
        pieces_(pieces),
        fields_(channels.size(), CellField(lattice)) {}

  RayIntegral integrate(const LatticeRay& lattice_ray) {
    RayIntegral ray;
    const std::vector<double> borders = find_borders(lattice_, lattice_ray);
    for (std::size_t i = 1; i < borders.size() && ray.optical_depth < kOpaque; ++i) {
      const double front = borders[i - 1], back = borders[i];
      const CellIndex cell = find_cell(lattice_, lattice_ray.at(0.5 * (front + back)));
      bool is_whole = true;
      for (std::size_t k = 0; k < channels_.size(); ++k) is_whole = is_whole && fields_[k].load(channels_[k], cell);
      if (!is_whole) continue;
      append_chord(make_chord(lattice_, cell, lattice_ray.at(front), lattice_ray.at(back), back - front), 0, ray);
    }
    return ray;
  }

 private:
  void append_pieces(const CellChord& chord, RayIntegral& ray) const {
    double front = fields_[0].eval(chord.at(0.0));
    for (int i = 1; i <= pieces_; ++i) {
      const double back = fields_[0].eval(chord.at(static_cast<double>(i) / pieces_));
      append_segment(function_, front, back, chord.length / pieces_, ray);
      front = back;
    }
  }

  void append_chord(const CellChord& chord, int halvings, RayIntegral& ray) const {
    if (pieces_ > 0 && fields_.size() == 1) return append_pieces(chord, ray);
    constexpr int kMostHalvings = 8;
    std::array<Curve, 4> curves;
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      curves[k] = make_curve(lattice_, fields_[k], chord);
      if (lattice_.filter.kind != FilterKind::kLanczos || halvings == kMostHalvings) continue;
      if (is_faithful(fields_[k], chord, curves[k])) continue;
      for (const CellChord& half : chord.split()) append_chord(half, halvings + 1, ray);
      return;
    }
    if (fields_.size() == 1) return append_curve(function_, curves[0], chord.length, ray);
    append_densities({curves[3], {curves[0], curves[1], curves[2]}}, chord.length, ray);
  }

  const Lattice& lattice_;
  const std::vector<std::vector<double>>& channels_;
  const OpticalFunction& function_;
  int pieces_;
  std::vector<CellField> fields_;
};

/// The function at a value; at a step the limit from above.
OpticalPoint eval_function(const OpticalFunction& function, double value) {
  return eval_piece(function, find_piece(function, value), value);
}

/// What is reconstructed: the field; or red, green and blue emission and extinction.
std::vector<std::vector<double>> make_channels(const std::vector<double>& values, const OpticalFunction& function,
                                               Classification classification) {
  if (classification == Classification::kOfField) return {values};
  std::vector<std::vector<double>> channels(4, values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    const OpticalPoint point = eval_function(function, values[i]);
    for (int k = 0; k < 3; ++k) channels[k][i] = point.extinction * point.color[k];
    channels[3][i] = point.extinction;
  }
  return channels;
}

}  // namespace

Image draw(const GridData& grid, const GridMethod& method, const OpticalFunction& function, const View& view) {
  const Lattice lattice = make_lattice(grid, method.filter);
  std::vector<std::vector<double>> channels = make_channels(make_values(grid), function, method.classification);
  for (auto& channel : channels) channel = make_coefficients(lattice, std::move(channel));
  const Screen screen(view);
  const CameraAxes axes(view.camera);
  Image image{view.drawn_width(), view.drawn_height(), {}};
  image.pixels.resize(4 * static_cast<std::size_t>(image.width) * image.height);
  tbb::parallel_for(0, image.height, [&](int row) {
    RayDrawer drawer(lattice, channels, function, method.pieces_per_cell);
    for (int column = 0; column < image.width; ++column) {
      const RayIntegral ray = drawer.integrate(make_lattice_ray(lattice, screen, axes, column, row));
      float* pixel = image.pixel(column, row);
      for (int k = 0; k < 3; ++k) pixel[k] = static_cast<float>(ray.color[k]);
      pixel[3] = static_cast<float>(-std::expm1(-ray.optical_depth));
    }
  });
  return image;
}

}  // namespace tetravox::reference
