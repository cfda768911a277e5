// SPDX-License-Identifier: GPL-3.0-or-later
// Delaunay refinement (Boissonnat & Oudot 2005) by CGAL's Surface_mesher, one surface a run. CGAL is under the GPL: this program is its
// own, and nothing of isostudy is linked with it. `make cgal` builds it; cgal_surface_mesher.py speaks docs/programs.md for it.
//
// usage: cgal-surface-mesher samples FILE NX NY NZ OX OY OZ SX SY SZ ISOVALUE ANGLE RADIUS DISTANCE MESH
//        cgal-surface-mesher version
//        cgal-surface-mesher sphere SIZE SEED ANGLE RADIUS DISTANCE
//
// FILE has 32-bit floats, x fastest; above the isovalue is inside, and between samples is their trilinear interpolant. ANGLE in degrees
// is the least of a triangle; RADIUS bounds the ball round a triangle that is centred on the surface; DISTANCE bounds how far that centre
// is from the triangle's own. Both are in the unit of the spacing. MESH is a PLY file, or `-` for none. A solid that ends at the box gets
// walls there. `sphere` is the exact field of a sphere of radius SIZE, with 20
// initial points that CGAL draws by SEED. One line of JSON says what came out.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include <CGAL/Complex_2_in_triangulation_3.h>
#include <CGAL/Implicit_surface_3.h>
#include <CGAL/Surface_mesh_default_triangulation_3.h>
#include <CGAL/make_surface_mesh.h>
#include <CGAL/version.h>

using Triangulation = CGAL::Surface_mesh_default_triangulation_3;
using Complex = CGAL::Complex_2_in_triangulation_3<Triangulation>;
using Traits = Triangulation::Geom_traits;
using Point = Traits::Point_3;
using Triangle = std::array<std::uint32_t, 3>;

struct Bounds {
    double angle, radius, distance;
};

struct Mesh {
    std::vector<Point> positions;
    std::vector<Triangle> triangles;
};

// What was called, counted: CGAL copies its function.
static std::uint64_t evaluations = 0;

class Samples {
public:
    std::array<long, 3> size;
    std::array<double, 3> origin, spacing;

    Samples(const char* path, std::array<long, 3> size, std::array<double, 3> origin, std::array<double, 3> spacing, double isovalue)
        : size(size), origin(origin), spacing(spacing), values(size[0] * size[1] * size[2]) {
        std::ifstream file(path, std::ios::binary);
        const auto bytes = std::streamsize(values.size() * sizeof(float));
        if (!file.read(reinterpret_cast<char*>(values.data()), bytes)) throw std::runtime_error(std::string("cannot read ") + path);
        make_finite(isovalue);
    }

    // Less than zero inside, as CGAL has it; a sample beyond the box is outside.
    double corner(long i, long j, long k) const {
        if (std::min({i, j, k}) < 0 || i >= size[0] || j >= size[1] || k >= size[2]) return outside;
        return values[i + size[0] * (j + size[1] * k)];
    }

    double operator()(const Point& p) const {
        std::array<long, 3> cell;
        std::array<double, 3> t;
        for (int a = 0; a < 3; ++a) {
            const double x = (p[a] - origin[a]) / spacing[a];
            if (!(x >= 0.0 && x <= double(size[a] - 1))) return outside;
            cell[a] = std::min(long(x), size[a] - 2);
            t[a] = x - double(cell[a]);
        }
        double rows[4];
        for (int row = 0; row < 4; ++row) {
            const long n = cell[0] + size[0] * (cell[1] + row % 2 + size[1] * (cell[2] + row / 2));
            rows[row] = values[n] + (double(values[n + 1]) - values[n]) * t[0];
        }
        const double low = rows[0] + (rows[1] - rows[0]) * t[1], high = rows[2] + (rows[3] - rows[2]) * t[1];
        return low + (high - low) * t[2];
    }

    double far(int axis) const { return origin[axis] + spacing[axis] * double(size[axis] - 1); }

private:
    std::vector<float> values;
    double outside = 1.0;

    // Turns samples into isovalue minus sample, where NaN and infinite ones are as far as the farthest of the others. A sample equal to
    // the isovalue is outside, so that it is not zero.
    void make_finite(double isovalue) {
        double farthest = 0.0;
        for (const float value : values) {
            if (std::isfinite(value)) farthest = std::max(farthest, std::abs(isovalue - value));
        }
        outside = farthest > 0.0 ? farthest : 1.0;
        for (float& value : values) {
            const double difference = std::isfinite(value) ? isovalue - value : value > 0.0f ? -outside : outside;
            value = float(difference < 0.0 ? difference : std::max(difference, outside * 1e-9));
        }
    }
};

// Points on the surface to begin with: in each of its pieces, up to 20 crossings of grid edges, spread over the piece. CGAL's own initial
// points, at random, miss small pieces.
class Seeds {
public:
    explicit Seeds(const Samples& samples) : samples(samples) {
        for (int a = 0; a < 3; ++a) cells[a] = samples.size[a] + 1;
        seen.resize(cells[0] * cells[1] * cells[2]);
    }

    std::vector<Point> find() {
        std::vector<Point> points;
        for (long n = 0; n < long(seen.size()); ++n) {
            if (seen[n] || !is_crossed(n)) continue;
            const std::vector<Point> piece = crossings_from(n);
            const std::size_t wanted = std::min<std::size_t>(piece.size(), 20);
            for (std::size_t i = 0; i < wanted; ++i) points.push_back(piece[i * piece.size() / wanted]);
        }
        return points;
    }

private:
    const Samples& samples;
    // A layer of cells lies round the box. Cell (0, 0, 0) ends at sample (0, 0, 0).
    std::array<long, 3> cells;
    std::vector<bool> seen;

    std::array<long, 3> place(long n) const { return {n % cells[0], n / cells[0] % cells[1], n / cells[0] / cells[1]}; }

    bool is_inside(const std::array<long, 3>& cell, int corner) const { return value(cell, corner) < 0.0; }

    double value(const std::array<long, 3>& cell, int corner) const {
        return samples.corner(cell[0] - 1 + (corner & 1), cell[1] - 1 + (corner >> 1 & 1), cell[2] - 1 + (corner >> 2));
    }

    bool is_crossed(long n) const {
        const auto cell = place(n);
        const bool first = is_inside(cell, 0);
        for (int corner = 1; corner < 8; ++corner) {
            if (is_inside(cell, corner) != first) return true;
        }
        return false;
    }

    // Whether both sides are at the face of a cell across an axis.
    bool is_face_crossed(const std::array<long, 3>& cell, int axis, bool high) const {
        int inside = 0;
        for (int corner = 0; corner < 8; ++corner) inside += bool(corner >> axis & 1) == high && is_inside(cell, corner);
        return inside != 0 && inside != 4;
    }

    std::vector<Point> crossings_from(long first) {
        std::vector<Point> points;
        std::vector<long> reached{first};
        seen[first] = true;
        for (std::size_t next = 0; next < reached.size(); ++next) {
            const auto cell = place(reached[next]);
            add_crossings(cell, points);
            for (int axis = 0; axis < 3; ++axis) {
                for (const bool high : {false, true}) {
                    const long step = axis == 0 ? 1 : axis == 1 ? cells[0] : cells[0] * cells[1];
                    if (cell[axis] == (high ? cells[axis] - 1 : 0) || !is_face_crossed(cell, axis, high)) continue;
                    const long neighbour = reached[next] + (high ? step : -step);
                    if (!seen[neighbour]) seen[neighbour] = true, reached.push_back(neighbour);
                }
            }
        }
        return points;
    }

    // Along the three edges at a cell's last corner, so that each is met once.
    void add_crossings(const std::array<long, 3>& cell, std::vector<Point>& points) const {
        const double high = value(cell, 7);
        for (int axis = 0; axis < 3; ++axis) {
            const double low = value(cell, 7 - (1 << axis));
            if ((low < 0.0) == (high < 0.0)) continue;
            std::array<double, 3> at;
            for (int a = 0; a < 3; ++a) {
                const double step = a == axis ? low / (low - high) - 1.0 : 0.0;
                at[a] = std::clamp(samples.origin[a] + samples.spacing[a] * (double(cell[a]) + step), samples.origin[a], samples.far(a));
            }
            points.emplace_back(at[0], at[1], at[2]);
        }
    }
};

// Turns triangles so that those of a piece agree, and the field falls inward. The field is asked at 64 triangles of a piece at most, on
// both sides of each: at the ends of the edge that is dual to it.
template <typename Field>
void turn_outward(const Complex& complex, const Field& field, const std::vector<Complex::Facet>& facets,
                  const std::vector<Point>& positions, std::vector<Triangle>& triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> sides;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(triangles[t][i], triangles[t][(i + 1) % 3]);
            sides[{low, high}].push_back(t);
        }
    }
    const auto has_side = [&](std::size_t t, std::uint32_t from, std::uint32_t to) {
        for (int i = 0; i < 3; ++i) {
            if (triangles[t][i] == from && triangles[t][(i + 1) % 3] == to) return true;
        }
        return false;
    };
    const Triangulation& triangulation = complex.triangulation();
    const auto value = [&](const Complex::Facet& side) {
        return triangulation.is_infinite(side.first) ? 1.0 : field(triangulation.dual(side.first));
    };
    // 1 where the side that sees corners counter-clockwise is outside and the other inside, -1 where they are the other way round.
    const auto vote = [&](std::size_t t, const Triangle& corners) {
        Complex::Facet side = facets[t], other = triangulation.mirror_facet(side);
        if (triangulation.is_infinite(side.first)) std::swap(side, other);
        const Point& beside = side.first->vertex(side.second)->point();
        const auto [p, q, r] = corners;
        if (CGAL::orientation(positions[p], positions[q], positions[r], beside) == CGAL::NEGATIVE) std::swap(side, other);
        const bool is_front_inside = value(side) < 0.0, is_back_inside = value(other) < 0.0;
        return int(is_back_inside) - int(is_front_inside);
    };
    std::vector<bool> done(triangles.size());
    for (std::size_t first = 0; first < triangles.size(); ++first) {
        if (done[first]) continue;
        std::vector<std::size_t> piece{first};
        done[first] = true;
        int votes = 0;
        for (std::size_t next = 0; next < piece.size(); ++next) {
            const Triangle here = triangles[piece[next]];
            if (next < 64) votes += vote(piece[next], here);
            for (int i = 0; i < 3; ++i) {
                const auto [low, high] = std::minmax(here[i], here[(i + 1) % 3]);
                for (const std::size_t t : sides[{low, high}]) {
                    if (done[t]) continue;
                    done[t] = true;
                    if (has_side(t, here[i], here[(i + 1) % 3])) std::swap(triangles[t][1], triangles[t][2]);
                    piece.push_back(t);
                }
            }
        }
        if (votes < 0) {
            for (const std::size_t t : piece) std::swap(triangles[t][1], triangles[t][2]);
        }
    }
}

// Refines from the seeds and `initial` points more that CGAL draws. Vertices are on the surface but for `error`, in radii of the sphere.
template <typename Field>
Mesh refine(const Field& field, const Traits::Sphere_3& sphere, double error, const std::vector<Point>& seeds, int initial,
            const Bounds& bounds) {
    const auto counted = [&field](const Point& p) { return ++evaluations, field(p); };
    Triangulation triangulation;
    triangulation.insert(seeds.begin(), seeds.end());
    Complex complex(triangulation);
    const CGAL::Implicit_surface_3<Traits, decltype(counted)> surface(counted, sphere, error);
    const CGAL::Surface_mesh_default_criteria_3<Triangulation> criteria(bounds.angle, bounds.radius, bounds.distance);
    CGAL::make_surface_mesh(complex, surface, criteria, CGAL::Manifold_tag(), initial);

    Mesh mesh;
    std::vector<Complex::Facet> facets;
    std::unordered_map<const void*, std::uint32_t> numbers;
    for (auto facet = complex.facets_begin(); facet != complex.facets_end(); ++facet) {
        Triangle triangle;
        for (int i = 0; i < 3; ++i) {
            const auto vertex = facet->first->vertex((facet->second + 1 + i) & 3);
            const auto [entry, is_new] = numbers.try_emplace(&*vertex, std::uint32_t(mesh.positions.size()));
            if (is_new) mesh.positions.push_back(vertex->point());
            triangle[i] = entry->second;
        }
        facets.push_back(*facet);
        mesh.triangles.push_back(triangle);
    }
    turn_outward(complex, field, facets, mesh.positions, mesh.triangles);
    return mesh;
}

// The smallest and the largest angle, in degrees.
std::array<double, 2> angles(const Mesh& mesh) {
    std::array<double, 2> found{180.0, 0.0};
    for (const Triangle& triangle : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const Point &p = mesh.positions[triangle[i]], &q = mesh.positions[triangle[(i + 1) % 3]], &r = mesh.positions[triangle[(i + 2) % 3]];
            const auto u = q - p, v = r - p;
            const double angle = std::acos(std::clamp(u * v / std::sqrt((u * u) * (v * v)), -1.0, 1.0)) * 180.0 / CGAL_PI;
            found = {std::min(found[0], angle), std::max(found[1], angle)};
        }
    }
    return found;
}

void write_ply(const char* path, const Mesh& mesh) {
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.positions.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
         << "\nproperty list uchar uint vertex_indices\nend_header\n";
    for (const Point& p : mesh.positions) {
        const float at[3] = {float(p[0]), float(p[1]), float(p[2])};
        file.write(reinterpret_cast<const char*>(at), sizeof at);
    }
    for (const Triangle& triangle : mesh.triangles) {
        file.put(3);
        file.write(reinterpret_cast<const char*>(triangle.data()), sizeof triangle);
    }
    if (!file.flush()) throw std::runtime_error(std::string("cannot write ") + path);
}

double number(const char* word) {
    char* end;
    const double value = std::strtod(word, &end);
    if (*word == '\0' || *end != '\0' || !std::isfinite(value)) throw std::runtime_error(std::string("not a number: ") + word);
    return value;
}

int run(int count, char** words) {
    // CGAL's own seed is the time.
    CGAL::get_default_random() = CGAL::Random(0);
    using Clock = std::chrono::steady_clock;
    const std::string kind = count > 1 ? words[1] : "";
    if (kind == "version" && count == 2) return std::puts(CGAL_VERSION_STR) < 0;
    const bool is_sphere = kind == "sphere" && count == 7;
    if (!is_sphere && !(kind == "samples" && count == 17)) throw std::runtime_error("usage: see the head of cgal_surface_mesher.cpp");
    std::vector<double> given;
    for (int i = is_sphere ? 2 : 3; i < (is_sphere ? 7 : 16); ++i) given.push_back(number(words[i]));
    Mesh mesh;
    Clock::time_point begin;
    if (is_sphere) {
        begin = Clock::now();
        const double square = given[0] * given[0];
        const auto sphere = [square](const Point& p) { return p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - square; };
        CGAL::get_default_random() = CGAL::Random(unsigned(given[1]));
        mesh = refine(sphere, Traits::Sphere_3(CGAL::ORIGIN, 2.0 * square), 1e-3, {}, 20, {given[2], given[3], given[4]});
    } else {
        const Samples samples(words[2], {long(given[0]), long(given[1]), long(given[2])}, {given[3], given[4], given[5]},
                              {given[6], given[7], given[8]}, given[9]);
        begin = Clock::now();
        const Point low(samples.origin[0], samples.origin[1], samples.origin[2]), high(samples.far(0), samples.far(1), samples.far(2));
        const std::vector<Point> seeds = Seeds(samples).find();
        // Larger than the box, whose corners may be surface.
        const Traits::Sphere_3 sphere(CGAL::midpoint(low, high), 0.3 * CGAL::squared_distance(low, high));
        if (!seeds.empty()) mesh = refine(samples, sphere, 1e-6, seeds, 0, {given[10], given[11], given[12]});
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    if (!is_sphere && std::string(words[16]) != "-") write_ply(words[16], mesh);
    const auto [least, most] = angles(mesh);
    std::printf("{\"vertices\": %zu, \"triangles\": %zu, \"extraction_s\": %.9f, \"evaluations\": %llu, \"smallest_angle\": %.3f, "
                "\"largest_angle\": %.3f}\n",
                mesh.positions.size(), mesh.triangles.size(), seconds, (unsigned long long)evaluations, least, most);
    return 0;
}

int main(int count, char** words) {
    try {
        return run(count, words);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cgal-surface-mesher: %s\n", error.what());
        return 1;
    }
}
