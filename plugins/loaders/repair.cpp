#include "repair.hpp"

#include "edge_groups.hpp"
#include "exact.hpp"
#include "line_votes.hpp"
#include "triangulate.hpp"
#include "weld.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace rt::loaders {
namespace {

class Repairer {
public:
    Repairer(const MeshFile& file, Repair level) : file_(file), level_(level) {
        out_.outcomes.resize(file.faceCount());
        out_.summary.faces = file.faceCount();
        out_.summary.vertices = static_cast<std::uint32_t>(file.positions.size());
    }

    RepairedMesh run() {
        out_.weld = weldEqual(file_.positions);
        for (std::uint32_t v = 0; v < out_.weld.size(); ++v)
            out_.summary.weldedVertices += out_.weld[v] != v;
        takeFaces();
        {
            const EdgeGroups groups(vertex_, start_, static_cast<std::uint32_t>(out_.weld.size()));
            if (level_ == Repair::full) {
                dropDuplicates(groups);
                findFlatFaces();
            }
            matchEdges(groups);
        }
        dropFlatFaces();
        flipped_.assign(faceCount(), 0);
        findComponents();
        if (level_ != Repair::none) orientComponents();
        countOpenEdges();
        emit();
        return std::move(out_);
    }

private:
    std::uint32_t faceCount() const { return static_cast<std::uint32_t>(source_.size()); }
    std::uint32_t cornersOf(std::uint32_t f) const { return start_[f + 1] - start_[f]; }
    std::uint32_t next(std::uint32_t h) const {
        const std::uint32_t f = face_[h];
        return h + 1 == start_[f + 1] ? start_[f] : h + 1;
    }
    const Vector3& position(std::uint32_t h) const { return file_.positions[vertex_[h]]; }
    std::uint32_t rawVertex(std::uint32_t h) const { return file_.cornerPosition[corner_[h]]; }

    void drop(std::uint32_t sourceFace, FaceReason reason) {
        out_.outcomes[sourceFace] = {FaceAction::dropped, reason};
    }
    bool dropped(std::uint32_t f) const {
        return out_.outcomes[source_[f]].action == FaceAction::dropped;
    }

    /// Faces with three distinct corners or more; a corner that repeats the one before it is passed over.
    void takeFaces() {
        const auto corners = file_.cornerPosition.size();
        vertex_.reserve(corners), corner_.reserve(corners), face_.reserve(corners);
        start_.reserve(file_.faceStart.size()), source_.reserve(file_.faceCount());
        start_.push_back(0);
        std::vector<std::uint32_t> distinct;
        for (std::uint32_t f = 0; f < file_.faceCount(); ++f) {
            const std::uint32_t from = file_.faceStart[f], to = file_.faceStart[f + 1];
            const auto begin = vertex_.size();
            for (std::uint32_t c = from; c < to; ++c) {
                const std::uint32_t v = out_.weld[file_.cornerPosition[c]];
                if (vertex_.size() > begin && vertex_.back() == v) continue;
                vertex_.push_back(v), corner_.push_back(c);
            }
            while (vertex_.size() > begin + 1 && vertex_.back() == vertex_[begin])
                vertex_.pop_back(), corner_.pop_back();
            bool enough = vertex_.size() - begin == 3;
            if (vertex_.size() - begin > 3) {
                distinct.assign(vertex_.begin() + static_cast<std::ptrdiff_t>(begin),
                                vertex_.end());
                std::sort(distinct.begin(), distinct.end());
                enough = std::unique(distinct.begin(), distinct.end()) - distinct.begin() >= 3;
            }
            if (!enough) {
                drop(f, to - from < 3 ? FaceReason::fewCorners : FaceReason::repeatedCorner);
                vertex_.resize(begin), corner_.resize(begin);
                continue;
            }
            face_.resize(vertex_.size(), faceCount());
            source_.push_back(f);
            start_.push_back(static_cast<std::uint32_t>(vertex_.size()));
        }
    }

    // ---- duplicates -----------------------------------------------------------------------------------------------

    enum class Likeness { different, same, reversed };

    /// Do the faces have the same corners in the same cyclic order, or in the opposite one? g is entered at
    /// half-edge hg, f at hf, which lie on the same edge.
    Likeness compare(std::uint32_t hf, std::uint32_t hg) const {
        const std::uint32_t f = face_[hf], g = face_[hg], n = cornersOf(f);
        if (n != cornersOf(g)) return Likeness::different;
        const bool same = vertex_[hf] == vertex_[hg];
        std::uint32_t a = next(next(hf));
        if (same) {
            for (std::uint32_t b = next(next(hg)), k = 2; k < n; ++k, a = next(a), b = next(b))
                if (vertex_[a] != vertex_[b]) return Likeness::different;
            return Likeness::same;
        }
        const auto before = [&](std::uint32_t h) {
            return h == start_[face_[h]] ? start_[face_[h] + 1] - 1 : h - 1;
        };
        for (std::uint32_t b = before(hg), k = 2; k < n; ++k, a = next(a), b = before(b))
            if (vertex_[a] != vertex_[b]) return Likeness::different;
        return Likeness::reversed;
    }

    std::uint64_t cornerSum(std::uint32_t f) const { // equal for like faces
        std::uint64_t sum = 0;
        for (std::uint32_t h = start_[f]; h < start_[f + 1]; ++h)
            sum += (vertex_[h] + std::uint64_t{1}) * 0x9E3779B97F4A7C15u >> 7;
        return sum;
    }

    struct Twin {
        std::uint32_t face, earlier; // earlier < face
        bool reversed;
    };

    void dropDuplicates(const EdgeGroups& groups) {
        std::vector<Twin> twins;
        std::vector<char>
            pairedInFile; // per half-edge: the file's own indices join it to exactly one other
        std::vector<std::uint32_t> sorted;
        const auto compareTwo = [&](std::uint32_t a, std::uint32_t b) {
            if (face_[a] > face_[b]) std::swap(a, b);
            if (face_[a] == face_[b]) return false;
            const Likeness likeness = compare(a, b);
            if (likeness == Likeness::different) return false;
            twins.push_back({face_[b], face_[a], likeness == Likeness::reversed});
            return true;
        };
        groups.forEach([&](std::span<const std::uint32_t> group) {
            if (group.size() == 2) {
                compareTwo(group[0], group[1]);
                return;
            }
            if (group.size() < 2) return;
            if (pairedInFile.empty()) pairedInFile.assign(vertex_.size(), 0);
            forEachFilePair(group, [&](std::uint32_t a, std::uint32_t b) {
                if (compare(a, b) == Likeness::different) pairedInFile[a] = pairedInFile[b] = 1;
            });
            // Sorting by sum keeps an edge with very many faces from costing their number squared.
            sorted.assign(group.begin(), group.end());
            std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
            for (const std::uint32_t h : sorted) keys.emplace_back(cornerSum(face_[h]), h);
            std::sort(keys.begin(), keys.end());
            for (std::size_t i = 0; i < keys.size();) {
                std::size_t j = i + 1;
                for (; j < keys.size() && keys[j].first == keys[i].first; ++j)
                    compareTwo(keys[i].second, keys[j].second);
                i = j;
            }
        });
        if (twins.empty()) return;
        std::sort(twins.begin(), twins.end(), [](const Twin& a, const Twin& b) {
            return std::pair(a.face, a.earlier) < std::pair(b.face, b.earlier);
        });
        // Two bodies that touch in a face both keep it: there, the file's own indices join each copy to its body.
        const auto joined = [&](std::uint32_t f) {
            if (pairedInFile.empty()) return false;
            for (std::uint32_t h = start_[f]; h < start_[f + 1]; ++h)
                if (!pairedInFile[h]) return false;
            return true;
        };
        std::erase_if(twins, [&](const Twin& t) { return joined(t.face) && joined(t.earlier); });
        const std::vector<char> lens = findLenses(groups, twins);
        for (const Twin& t : twins) {
            if (dropped(t.face)) continue;
            if (t.reversed && lens[t.earlier] && twin_[t.earlier] == kNone) {
                twin_[t.face] = t.earlier, twin_[t.earlier] = t.face;
                continue;
            }
            if (twin_[t.face] != kNone) continue;
            drop(source_[t.face],
                 t.reversed ? FaceReason::reversedDuplicate : FaceReason::duplicate);
        }
    }

    /// A patch of doubled faces that hangs on a body, both sides of it on edges that are closed without it, is a body without thickness. Where it
    /// fills a hole of single faces, or stands alone, one side of it is a sheet and the other a duplicate. Per face: is
    /// it of the first kind? Decided by the number of single faces on the edges of the patch.
    std::vector<char> findLenses(const EdgeGroups& groups, const std::vector<Twin>& twins) {
        twin_.assign(faceCount(), kNone);
        std::vector<std::uint32_t> patch(faceCount(), kNone); // parent in a forest of patches
        for (const Twin& t : twins) patch[t.face] = patch[t.earlier] = t.earlier;
        for (const Twin& t : twins) patch[t.earlier] = t.earlier;
        const auto root = [&](std::uint32_t f) {
            while (patch[f] != f) f = patch[f] = patch[patch[f]];
            return f;
        };
        groups.forEach([&](std::span<const std::uint32_t> group) {
            std::uint32_t first = kNone;
            for (const std::uint32_t h : group) {
                if (patch[face_[h]] == kNone) continue;
                const std::uint32_t r = root(face_[h]);
                if (first == kNone)
                    first = r;
                else
                    patch[std::max(first, r)] = std::min(first, r), first = std::min(first, r);
            }
        });
        std::vector<int> votes(faceCount(), 0);
        groups.forEach([&](std::span<const std::uint32_t> group) {
            std::uint32_t any = kNone, singles = 0;
            for (const std::uint32_t h : group) {
                if (patch[face_[h]] == kNone)
                    ++singles;
                else
                    any = face_[h];
            }
            if (any != kNone && singles != 0) votes[root(any)] += singles % 2 == 0 ? 1 : -1;
        });
        std::vector<char> lens(faceCount(), 0);
        for (std::uint32_t f = 0; f < faceCount(); ++f)
            if (patch[f] != kNone) lens[f] = votes[root(f)] > 0;
        return lens;
    }

    /// Pairs of half-edges of a group that exactly two faces of the file share by index.
    template <class Visit>
    void forEachFilePair(std::span<const std::uint32_t> group, Visit&& visit) const {
        std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>> byIndex;
        for (const std::uint32_t h : group) {
            const auto ends = std::minmax({rawVertex(h), rawVertex(next(h))});
            byIndex.push_back({{ends.first, ends.second}, h});
        }
        std::sort(byIndex.begin(), byIndex.end());
        for (std::size_t i = 0; i < byIndex.size();) {
            std::size_t j = i + 1;
            while (j < byIndex.size() && byIndex[j].first == byIndex[i].first) ++j;
            if (j - i == 2) visit(byIndex[i].second, byIndex[i + 1].second);
            i = j;
        }
    }

    // ---- edges ----------------------------------------------------------------------------------------------------

    enum class Flatness : char { none, nearly, exactly };

    /// Triangles thinner than the rounding of single precision, in which most files were made, and faces whose corners
    /// lie on a line.
    void findFlatFaces() {
        double coordinate = 0;
        for (const Vector3& p : file_.positions)
            coordinate = std::max({coordinate, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
        // Three corners, each off by half a unit in the last place in two directions.
        const double thin = 2 * std::numeric_limits<float>::epsilon() * coordinate;
        for (std::uint32_t f = 0; f < faceCount(); ++f) {
            const std::uint32_t first = start_[f];
            Flatness flatness = Flatness::none;
            if (cornersOf(f) == 3) {
                const Vector3 ab = position(first + 1) - position(first);
                const Vector3 ac = position(first + 2) - position(first);
                const Vector3 bc = ac - ab;
                const double longest = std::sqrt(std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)}));
                if (length(cross(ab, ac)) <= thin * longest) flatness = Flatness::nearly;
            }
            if (cornersOf(f) != 3 || flatness == Flatness::nearly) {
                bool flat = true;
                for (std::uint32_t h = first + 2; h < start_[f + 1] && flat; ++h)
                    flat = collinear(position(first), position(first + 1), position(h));
                if (flat) flatness = Flatness::exactly;
            }
            if (flatness == Flatness::none) continue;
            if (flat_.empty())
                flat_.assign(faceCount(), Flatness::none), crowded_.assign(faceCount(), 0);
            flat_[f] = flatness;
        }
    }

    bool isFlat(std::uint32_t f) const { return !flat_.empty() && flat_[f] != Flatness::none; }

    void join(std::uint32_t a, std::uint32_t b) {
        // A face that runs the same way twice along one edge has no other side there.
        const bool sameWay = vertex_[a] == vertex_[b];
        if (sameWay && (face_[a] == face_[b] || level_ == Repair::none)) return;
        out_.mate[a] = b, out_.mate[b] = a;
    }

    /// The half-edges of an edge are joined in twos: those that the file joins by index first, then two
    /// that are left, then twins with each other. Faces without area join what is open without them.
    void matchEdges(const EdgeGroups& groups) {
        out_.mate.assign(vertex_.size(), kNone);
        std::vector<std::uint32_t> here, twins, flat;
        const auto joinTwo = [&](std::vector<std::uint32_t>& two) {
            if (two.size() == 2) join(two[0], two[1]), two.clear();
        };
        groups.forEach([&](std::span<const std::uint32_t> group) {
            if (group.size() == 2 && !dropped(face_[group[0]]) && !dropped(face_[group[1]]))
                return join(group[0], group[1]);
            if (group.size() < 2) return;
            here.clear(), twins.clear(), flat.clear();
            for (const std::uint32_t h : group) {
                const std::uint32_t f = face_[h];
                if (dropped(f)) continue;
                (isFlat(f)                             ? flat
                 : !twin_.empty() && twin_[f] != kNone ? twins
                                                       : here)
                    .push_back(h);
            }
            if (here.size() + twins.size() > 2) {
                ++out_.summary.nonManifoldEdges;
                forEachFilePair(here, [&](std::uint32_t a, std::uint32_t b) { join(a, b); });
                std::erase_if(here, [&](std::uint32_t h) { return out_.mate[h] != kNone; });
            }
            if (!flat.empty() && here.size() + twins.size() >= 2)
                for (const std::uint32_t h : flat) crowded_[face_[h]] = 1;
            joinTwo(here), joinTwo(twins);
            here.insert(here.end(), flat.begin(), flat.end());
            joinTwo(here);
        });
    }

    /// Faces without area are never seen; thin ones are. Either is dropped where it only hangs on an edge that others close, and its own are
    /// open. The rest stays to join its neighbours.
    void dropFlatFaces() {
        if (flat_.empty()) return;
        std::vector<std::uint32_t> work;
        for (std::uint32_t f = 0; f < faceCount(); ++f)
            if (isFlat(f) && !dropped(f)) work.push_back(f);
        while (!work.empty()) {
            const std::uint32_t f = work.back();
            work.pop_back();
            if (dropped(f) || (flat_[f] == Flatness::nearly && !crowded_[f])) continue;
            bool open = false;
            for (std::uint32_t h = start_[f]; h < start_[f + 1]; ++h) open |= out_.mate[h] == kNone;
            if (!open) continue;
            drop(source_[f], FaceReason::zeroArea);
            for (std::uint32_t h = start_[f]; h < start_[f + 1]; ++h) {
                const std::uint32_t m = std::exchange(out_.mate[h], kNone);
                if (m == kNone) continue;
                out_.mate[m] = kNone;
                if (isFlat(face_[m])) work.push_back(face_[m]);
            }
        }
    }

    // ---- orientation ----------------------------------------------------------------------------------------------

    struct Component {
        bool orientable = true, closed = false;
    };

    bool disagree(std::uint32_t a,
                  std::uint32_t b) const { // do two joined half-edges run the same way?
        return (vertex_[a] == vertex_[b]) != (flipped_[face_[a]] != flipped_[face_[b]]);
    }

    void findComponents() {
        component_.assign(faceCount(), kNone);
        std::vector<std::uint32_t> queue;
        std::vector<std::uint32_t> sizes;
        for (std::uint32_t seed = 0; seed < faceCount(); ++seed) {
            if (component_[seed] != kNone || dropped(seed)) continue;
            const auto id = static_cast<std::uint32_t>(components_.size());
            components_.push_back({});
            queue.assign(1, seed);
            component_[seed] = id;
            std::uint32_t turned = 0;
            for (std::size_t i = 0; i < queue.size(); ++i) {
                const std::uint32_t f = queue[i];
                turned += flipped_[f];
                for (std::uint32_t h = start_[f]; h < start_[f + 1]; ++h) {
                    const std::uint32_t m = out_.mate[h];
                    if (m == kNone || component_[face_[m]] != kNone) continue;
                    const std::uint32_t g = face_[m];
                    component_[g] = id;
                    if (level_ != Repair::none)
                        flipped_[g] = flipped_[f] ^ (vertex_[h] == vertex_[m]);
                    queue.push_back(g);
                }
            }
            // The majority stays as it is wound in the file.
            if (2 * std::size_t{turned} > queue.size())
                for (const std::uint32_t f : queue) flipped_[f] ^= 1;
            faces_.insert(faces_.end(), queue.begin(), queue.end());
            componentStart_.push_back(static_cast<std::uint32_t>(faces_.size()));
        }
        out_.summary.components = static_cast<std::uint32_t>(components_.size());
    }

    std::span<const std::uint32_t> facesOf(std::size_t component) const {
        return {faces_.data() + componentStart_[component],
                faces_.data() + componentStart_[component + 1]};
    }

    void flip(std::size_t component) {
        for (const std::uint32_t f : facesOf(component)) flipped_[f] ^= 1;
        inverted_[component] = 1;
        ++out_.summary.turnedComponents;
    }

    void orientComponents() {
        cutSeams();
        findClosed();
        inverted_.assign(components_.size(), 0);
        const PolygonView view{file_.positions, vertex_, start_};
        std::vector<std::uint32_t> closed;
        for (std::uint32_t c = 0; c < components_.size(); ++c) {
            if (components_[c].closed) {
                closed.push_back(c);
                continue;
            }
            if (!components_[c].orientable) continue;
            // Less than five votes of eight for one side is no majority to turn a mesh on.
            constexpr double kDecided = 0.25;
            const auto faces = facesOf(c);
            double vote = faces.size() == 1 ? 0 : outsideVote(view, faces, flipped_);
            if (std::fabs(vote) < kDecided) vote = fileNormalVote(faces);
            if (std::fabs(vote) < kDecided)
                ++out_.summary.undefinedComponents;
            else if (vote < 0)
                flip(c);
        }
        orientClosed(closed, view);
    }

    /// One-sided components keep the file's winding unless ours changes sides along fewer edges.
    void cutSeams() {
        std::vector<std::uint32_t> ours(components_.size()), files(components_.size());
        for (std::uint32_t h = 0; h < vertex_.size(); ++h) {
            const std::uint32_t m = out_.mate[h];
            if (m == kNone || m < h || dropped(face_[h])) continue;
            const std::uint32_t c = component_[face_[h]];
            ours[c] += disagree(h, m);
            files[c] += vertex_[h] == vertex_[m];
        }
        bool any = false;
        for (std::uint32_t c = 0; c < components_.size(); ++c) {
            if (ours[c] == 0) continue;
            any = true;
            components_[c].orientable = false;
            ++out_.summary.unorientableComponents;
            if (files[c] <= ours[c])
                for (const std::uint32_t f : facesOf(c)) flipped_[f] = 0;
            out_.summary.seamEdges += std::min(files[c], ours[c]);
        }
        if (!any) return;
        for (std::uint32_t h = 0; h < vertex_.size(); ++h) {
            const std::uint32_t m = out_.mate[h];
            if (m == kNone || dropped(face_[h]) || !disagree(h, m)) continue;
            out_.mate[h] = out_.mate[m] = kNone;
        }
    }

    struct OpenHalf { // without a mate; +1 where it runs to the higher vertex
        std::uint32_t component, low, high;
        int direction;
        auto key() const { return std::tuple(component, low, high); }
    };

    std::vector<OpenHalf> openHalves(bool byComponent) const {
        std::vector<OpenHalf> open;
        for (std::uint32_t h = 0; h < vertex_.size(); ++h) {
            if (out_.mate[h] != kNone || dropped(face_[h])) continue;
            const std::uint32_t a = vertex_[h], b = vertex_[next(h)];
            open.push_back({byComponent ? component_[face_[h]] : 0, std::min(a, b), std::max(a, b),
                            (a < b) != (flipped_[face_[h]] != 0) ? 1 : -1});
        }
        std::sort(open.begin(), open.end(),
                  [](const OpenHalf& a, const OpenHalf& b) { return a.key() < b.key(); });
        return open;
    }

    template <class Visit>
    static void forEachUnbalanced(const std::vector<OpenHalf>& open, Visit&& visit) {
        for (std::size_t i = 0; i < open.size();) {
            std::size_t j = i;
            int sum = 0;
            for (; j < open.size() && open[j].key() == open[i].key(); ++j) sum += open[j].direction;
            if (sum != 0) visit(open[i]);
            i = j;
        }
    }

    /// A component is closed when its faces cancel along every edge, also where more than two of them meet.
    void findClosed() {
        for (Component& c : components_) c.closed = c.orientable;
        forEachUnbalanced(openHalves(true),
                          [&](const OpenHalf& h) { components_[h.component].closed = false; });
    }

    void countOpenEdges() {
        forEachUnbalanced(openHalves(false), [&](const OpenHalf&) { ++out_.summary.openEdges; });
    }

    /// Twice the share by which the file's normals agree with the winding, less one; 0 without normals.
    double fileNormalVote(std::span<const std::uint32_t> faces) const {
        if (file_.cornerNormal.empty()) return 0;
        long votes = 0, total = 0;
        std::vector<Vector3> polygon;
        for (const std::uint32_t f : faces) {
            polygon.clear();
            for (std::uint32_t h = start_[f]; h < start_[f + 1]; ++h)
                polygon.push_back(position(h));
            const Vector3 normal = newellNormal(polygon) * (flipped_[f] ? -1.0 : 1.0);
            for (std::uint32_t h = start_[f]; h < start_[f + 1]; ++h) {
                const std::uint32_t n = file_.cornerNormal[corner_[h]];
                if (n == kNone) continue;
                const double along = dot(file_.normals[n], normal);
                votes += (along > 0) - (along < 0);
                total += along != 0;
            }
        }
        return total == 0 ? 0 : static_cast<double>(votes) / static_cast<double>(total);
    }

    /// Sign of the volume inside a closed component as it is wound now; 0 when it is within rounding of nothing.
    int volumeSign(std::uint32_t c) const {
        const Vector3 origin = position(start_[facesOf(c)[0]]);
        double volume = 0, size = 0;
        int terms = 0;
        for (const std::uint32_t f : facesOf(c)) {
            const Vector3 a = position(start_[f]) - origin;
            for (std::uint32_t h = start_[f] + 1; h + 1 < start_[f + 1]; ++h) {
                const Vector3 b = position(h) - origin, d = position(h + 1) - origin;
                const double six = dot(a, cross(b, d));
                volume += flipped_[f] ? -six : six;
                const auto magnitude = [](const Vector3& v) {
                    return Vector3{std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)};
                };
                const Vector3 A = magnitude(a), B = magnitude(b), D = magnitude(d);
                size += A.x * (B.y * D.z + B.z * D.y) + A.y * (B.z * D.x + B.x * D.z) +
                        A.z * (B.x * D.y + B.y * D.x);
                ++terms;
            }
        }
        // Three subtractions, two products, three sums round each term, then the terms are added up
        // [Higham 2002, 4.2]; the sum of magnitudes has as many roundings, hence the factor.
        const double bound = 2 * gamma(std::min(terms, 1 << 24) + 8) * size;
        return volume > bound ? 1 : volume < -bound ? -1 : 0;
    }

    /// A closed body is wound outward. One inside another may be its cavity or a body of its own, so it is turned when, and
    /// only when, the one around it is.
    void orientClosed(const std::vector<std::uint32_t>& closed, const PolygonView& view) {
        struct Body {
            std::uint32_t component;
            Vector3 lower, upper, point;
            std::vector<std::uint32_t> around; // closed components that hold it
            int sign;
        };
        std::vector<Body> bodies;
        for (const std::uint32_t c : closed) {
            Body b{c,
                   {kInfinity, kInfinity, kInfinity},
                   {-kInfinity, -kInfinity, -kInfinity},
                   {},
                   {},
                   volumeSign(c)};
            for (const std::uint32_t f : facesOf(c))
                for (std::uint32_t h = start_[f]; h < start_[f + 1]; ++h) {
                    const Vector3& p = position(h);
                    b.lower = {std::min(b.lower.x, p.x), std::min(b.lower.y, p.y),
                               std::min(b.lower.z, p.z)};
                    b.upper = {std::max(b.upper.x, p.x), std::max(b.upper.y, p.y),
                               std::max(b.upper.z, p.z)};
                }
            b.point = position(start_[facesOf(c)[0]]);
            bodies.push_back(std::move(b));
        }
        std::sort(bodies.begin(), bodies.end(), [](const Body& a, const Body& b) {
            return std::pair(a.lower.x, a.component) < std::pair(b.lower.x, b.component);
        });
        std::vector<Vector3> points;
        std::vector<std::size_t> candidates;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            points.clear(), candidates.clear();
            const Body& outer = bodies[i];
            for (std::size_t j = i + 1; j < bodies.size() && bodies[j].lower.x < outer.upper.x;
                 ++j) {
                const Body& b = bodies[j];
                if (b.lower.x > outer.lower.x && b.upper.x < outer.upper.x &&
                    b.lower.y > outer.lower.y && b.upper.y < outer.upper.y &&
                    b.lower.z > outer.lower.z && b.upper.z < outer.upper.z)
                    points.push_back(b.point), candidates.push_back(j);
            }
            if (points.empty()) continue;
            const std::vector<char> inside = insideOf(view, facesOf(outer.component), points);
            for (std::size_t k = 0; k < candidates.size(); ++k)
                if (inside[k])
                    bodies[candidates[k]].around.push_back(static_cast<std::uint32_t>(i));
        }
        // The outermost first: what holds a body is held by fewer than the body is.
        std::vector<std::size_t> order(bodies.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return bodies[a].around.size() < bodies[b].around.size();
        });
        for (const std::size_t i : order) {
            const Body& b = bodies[i];
            if (b.around.empty()) {
                if (b.sign < 0)
                    flip(b.component);
                else if (b.sign == 0)
                    ++out_.summary.undefinedComponents;
                continue;
            }
            ++out_.summary.nestedComponents;
            std::uint32_t parent = b.around[0];
            for (const std::uint32_t a : b.around)
                if (bodies[a].around.size() > bodies[parent].around.size()) parent = a;
            if (inverted_[bodies[parent].component]) flip(b.component);
        }
    }

    // ---- the result -----------------------------------------------------------------------------------------------

    void emit() {
        // Half-edges of a turned face: corner order c0, c(n-1), ..., c1, so edge i becomes edge n - 1 - i.
        std::vector<std::uint32_t> moved(vertex_.size(), kNone);
        out_.faceStart.push_back(0);
        out_.faceStart.reserve(start_.size()), out_.sourceFace.reserve(source_.size());
        out_.corners.reserve(corner_.size());
        for (std::uint32_t f = 0; f < faceCount(); ++f) {
            if (dropped(f)) continue;
            const std::uint32_t n = cornersOf(f);
            const auto begin = static_cast<std::uint32_t>(out_.corners.size());
            FaceOutcome& outcome = out_.outcomes[source_[f]];
            for (std::uint32_t i = 0; i < n; ++i) {
                out_.corners.push_back(corner_[start_[f] + (flipped_[f] ? (n - i) % n : i)]);
                moved[start_[f] + i] = begin + (flipped_[f] ? n - 1 - i : i);
            }
            if (flipped_[f])
                outcome = {FaceAction::flipped, inverted_[component_[f]]
                                                    ? FaceReason::insideOut
                                                    : FaceReason::againstNeighbours};
            if (isFlat(f) && flat_[f] == Flatness::exactly)
                drop(source_[f], FaceReason::zeroArea); // it stays to connect its neighbours
            out_.sourceFace.push_back(source_[f]);
            out_.faceStart.push_back(static_cast<std::uint32_t>(out_.corners.size()));
        }
        std::vector<std::uint32_t> mate(out_.corners.size(), kNone);
        for (std::uint32_t h = 0; h < vertex_.size(); ++h)
            if (moved[h] != kNone && out_.mate[h] != kNone) mate[moved[h]] = moved[out_.mate[h]];
        out_.mate = std::move(mate);
        for (const FaceOutcome& o : out_.outcomes)
            ++out_.summary.outcomes[static_cast<std::size_t>(o.reason)];
    }

    const MeshFile& file_;
    const Repair level_;
    RepairedMesh out_;
    // The faces under repair; half-edge h leaves corner h.
    std::vector<std::uint32_t> start_, source_; // per face
    std::vector<std::uint32_t> vertex_, corner_,
        face_;                             // per corner: welded vertex, corner of the file, face
    std::vector<char> flipped_;            // per face; flat_ empty: none
    std::vector<Flatness> flat_;           // per face; empty: none is
    std::vector<char> crowded_;            // per face: lies on an edge that two others close
    std::vector<std::uint32_t> twin_;      // per face: its reversed copy, where both stay
    std::vector<std::uint32_t> component_; // per face
    std::vector<Component> components_;
    std::vector<std::uint32_t> faces_, componentStart_{0}; // faces by component
    std::vector<char> inverted_;                           // per component
};

} // namespace

const char* text(FaceAction action) {
    switch (action) {
    case FaceAction::kept:
        return "kept";
    case FaceAction::flipped:
        return "flipped";
    case FaceAction::dropped:
        return "dropped";
    }
    return "";
}

const char* text(FaceReason reason) {
    switch (reason) {
    case FaceReason::none:
        return "";
    case FaceReason::againstNeighbours:
        return "wound against its neighbours";
    case FaceReason::insideOut:
        return "its component was wound inside out";
    case FaceReason::fewCorners:
        return "fewer than three corners";
    case FaceReason::repeatedCorner:
        return "fewer than three distinct corners";
    case FaceReason::zeroArea:
        return "no area";
    case FaceReason::duplicate:
        return "duplicate of an earlier face";
    case FaceReason::reversedDuplicate:
        return "duplicate of an earlier face, wound the other way";
    }
    return "";
}

std::vector<std::string> RepairSummary::notes() const {
    std::vector<std::string> out;
    const auto say = [&](std::uint32_t n, const char* one, const char* many) {
        if (n != 0) out.push_back(std::to_string(n) + " " + (n == 1 ? one : many));
    };
    const std::uint32_t few = count(FaceReason::fewCorners) + count(FaceReason::repeatedCorner);
    const std::uint32_t twice = count(FaceReason::duplicate) + count(FaceReason::reversedDuplicate);
    say(few, "face with fewer than three distinct corners was dropped",
        "faces with fewer than three distinct corners were dropped");
    say(count(FaceReason::zeroArea), "face without area was dropped",
        "faces without area were dropped");
    say(twice, "duplicate face was dropped", "duplicate faces were dropped");
    say(count(FaceReason::againstNeighbours), "face wound against its neighbours was turned",
        "faces wound against their neighbours were turned");
    if (turnedComponents != 0)
        out.push_back(std::to_string(turnedComponents) + " of " + std::to_string(components) +
                      " components were wound inside out and were turned (" +
                      std::to_string(count(FaceReason::insideOut)) + " faces)");
    say(nonManifoldEdges, "edge is shared by more than two faces",
        "edges are shared by more than two faces");
    say(unorientableComponents,
        "component is one-sided (as a Moebius strip); its winding cannot be made consistent",
        "components are one-sided (as a Moebius strip); their winding cannot be made consistent");
    say(undefinedComponents, "component has no defined outside; it stays as it is wound",
        "components have no defined outside; they stay as they are wound");
    return out;
}

RepairedMesh repair(const MeshFile& file, Repair level) { return Repairer(file, level).run(); }

} // namespace rt::loaders
