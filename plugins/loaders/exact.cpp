#include "exact.hpp"

#include <cmath>

namespace rt::loaders {
namespace {

/// A sum of doubles without rounding: components do not overlap and rise in size.
class Expansion {
public:
    void addProduct(double a, double b) {
        // Veltkamp's split and Dekker's product: a * b == high + low.
        const double high = a * b;
        const auto [aHigh, aLow] = split(a);
        const auto [bHigh, bLow] = split(b);
        const double low = ((aHigh * bHigh - high) + aHigh * bLow + aLow * bHigh) + aLow * bLow;
        add(low);
        add(high);
    }
    int sign() const {
        for (int i = size_ - 1; i >= 0; --i)
            if (components_[i] != 0) return components_[i] > 0 ? 1 : -1;
        return 0;
    }

private:
    struct Halves {
        double high, low;
    };
    static Halves split(double a) {
        constexpr double kSplitter = 134217729; // 2^27 + 1
        const double c = kSplitter * a;
        const double high = c - (c - a);
        return {high, a - high};
    }
    /// GROW-EXPANSION: Knuth's two-sum along the components.
    void add(double b) {
        double sum = b;
        for (int i = 0; i < size_; ++i) {
            const double a = components_[i];
            const double next = sum + a;
            const double virtualA = next - sum;
            components_[i] = (sum - (next - virtualA)) + (a - virtualA);
            sum = next;
        }
        components_[size_++] = sum;
    }

    double components_[12];
    int size_ = 0;
};

} // namespace

int orientation(Vector2 a, Vector2 b, Vector2 c) {
    const double left = (a.x - c.x) * (b.y - c.y);
    const double right = (a.y - c.y) * (b.x - c.x);
    const double area = left - right;
    // ccwerrboundA = (3 + 16 u) u < gamma(4) [Shewchuk 1997, figure 21].
    const double bound = gamma(4) * (std::fabs(left) + std::fabs(right));
    if (area > bound) return 1;
    if (area < -bound) return -1;
    Expansion exact; // a x b + b x c + c x a
    exact.addProduct(a.x, b.y);
    exact.addProduct(-a.y, b.x);
    exact.addProduct(b.x, c.y);
    exact.addProduct(-b.y, c.x);
    exact.addProduct(c.x, a.y);
    exact.addProduct(-c.y, a.x);
    return exact.sign();
}

bool collinear(Vector3 a, Vector3 b, Vector3 c) {
    return orientation({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == 0 &&
           orientation({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) == 0 &&
           orientation({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) == 0;
}

} // namespace rt::loaders
