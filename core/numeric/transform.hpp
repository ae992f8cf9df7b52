// Affine maps, named destination-from-source. Points, directions and normals are three verbs.
#pragma once
#include <core/numeric/angle.hpp>
#include <core/numeric/box.hpp>
#include <core/numeric/rounding.hpp>
#include <core/numeric/vec.hpp>

#include <optional>

namespace rt::numeric {

struct AffineTransform {
    Mat3 linear{1.0};
    Vec3 translation{0.0};

    Vec3 point(const Vec3& p) const { return linear * p + translation; }
    Vec3 direction(const Vec3& d) const { return linear * d; }
    /// By the inverse transpose up to a positive factor: outward stays outward, under a mirror too.
    /// Not unit.
    Vec3 normal(const Vec3& n) const {
        const Vec3 image = cofactors() * n;
        return determinant() < 0 ? -image : image;
    }
    double determinant() const { return dot(linear[0], cross(linear[1], linear[2])); }
    /// Precondition: determinant() is not 0.
    AffineTransform inverse() const {
        const Mat3 back = glm::transpose(cofactors()) * (1 / determinant());
        return {back, -(back * translation)};
    }
    /// By how much a similarity scales lengths; nothing for any other map or the zero map.
    /// The columns of a product
    /// of rotations may differ from orthogonal by kSimilarityError.
    std::optional<double> similarityScale() const;
    bool isIdentity() const { return linear == Mat3(1.0) && translation == Vec3(0.0); }

private:
    Mat3 cofactors() const {
        return {cross(linear[1], linear[2]), cross(linear[2], linear[0]),
                cross(linear[0], linear[1])};
    }
};

inline std::optional<double> AffineTransform::similarityScale() const {
    const double xx = lengthSquared(linear[0]), yy = lengthSquared(linear[1]),
                 zz = lengthSquared(linear[2]);
    const double mean = (xx + yy + zz) / 3, slack = kSimilarityError * mean;
    const auto near = [&](double a, double b) { return std::fabs(a - b) <= slack; };
    if (!(mean > 0) || !near(xx, yy) || !near(yy, zz) || !near(zz, xx) ||
        !near(dot(linear[0], linear[1]), 0) || !near(dot(linear[1], linear[2]), 0) ||
        !near(dot(linear[2], linear[0]), 0))
        return {};
    const double scale = std::fabs(linear[0].x);
    if (abs(linear[0]) == Vec3(scale, 0, 0) && abs(linear[1]) == Vec3(0, scale, 0) &&
        abs(linear[2]) == Vec3(0, 0, scale))
        return scale; // exactly
    return std::sqrt(mean);
}

inline AffineTransform operator*(const AffineTransform& a, const AffineTransform& b) {
    return {a.linear * b.linear, a.linear * b.translation + a.translation};
}

/// The box of a box: per axis the extremes of a sum of four terms, whose rounding γ(8) bounds relative to the terms'
/// magnitudes.
inline Box3d boundsOf(const AffineTransform& transform, const Box3d& from) {
    if (transform.isIdentity()) return from;
    Box3d box;
    for (int axis = 0; axis < 3; ++axis) {
        double least = transform.translation[axis], most = least, magnitude = std::fabs(least);
        for (int k = 0; k < 3; ++k) {
            const double m = transform.linear[k][axis], p = m * from.min[k], q = m * from.max[k];
            least += p < q ? p : q;
            most += p < q ? q : p;
            magnitude += std::fabs(m) * std::fmax(std::fabs(from.min[k]), std::fabs(from.max[k]));
        }
        box.min[axis] = least - gamma(8) * magnitude;
        box.max[axis] = most + gamma(8) * magnitude;
    }
    return box;
}

/// Right-handed turn about the axis through the origin; `axis` of any finite length but 0. Through
/// `numeric`'s own sine and cosine: same bits on every CPU.
AffineTransform rotation(const Vec3& axis, Radians angle);

} // namespace rt::numeric
