// The kernels of wave.hpp, in terms of lanes.inl. Every expression repeats one
// of direction.hpp, whitted.hpp or geometry/surface.cpp operation by operation.
//
// Nothing here may call an inline function of another header: see octree/kernel.inl.

struct V3 {
    F64 x, y, z;
};

inline V3 load(const Columns& c, std::size_t i) {
    return {load(c.x, i), load(c.y, i), load(c.z, i)};
}
inline void store(Columns& c, std::size_t i, V3 v) {
    store(c.x, i, v.x);
    store(c.y, i, v.y);
    store(c.z, i, v.z);
}
inline V3 operator+(V3 a, V3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V3 operator-(V3 a, V3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline V3 operator*(V3 a, V3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline V3 operator-(V3 a) { return {-a.x, -a.y, -a.z}; }
inline V3 operator*(V3 a, F64 s) { return {a.x * s, a.y * s, a.z * s}; }
inline V3 operator/(V3 a, F64 s) { return {a.x / s, a.y / s, a.z / s}; }
inline V3 select(I64 mask, V3 a, V3 b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
inline V3 magnitude(V3 a) { return {magnitude(a.x), magnitude(a.y), magnitude(a.z)}; }
inline F64 dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// numeric::bits::larger, of numbers.
inline F64 larger(F64 a, F64 b) { return select(a >= b, a, b); }

/// numeric::bits::nextUp.
inline F64 nextUp(F64 x) {
    const I64 b = bitsOf(x);
    const I64 next = x > 0 ? b + 1 : b - 1;
    const I64 least = b - b + 1; // of the denormals
    return select(x < __builtin_inf(), ofBits(x == 0 ? least : next), x);
}

inline F64 awayFrom(F64 from, F64 offset) {
    const F64 moved = from + offset;
    const F64 up = nextUp(offset < 0 ? -moved : moved);
    return select(offset > 0, up, select(offset < 0, -up, moved));
}

/// Where geometry::spawnRay and spawnRayTo start toward `direction`. geometric: turned toward the viewer.
inline V3 spawnOrigin(V3 position, V3 geometric, I64 leaving, F64 error, V3 direction) {
    const V3 outside = select(leaving, -geometric, geometric);
    const V3 offset = outside * select(dot(direction, outside) >= 0, error, -error);
    return {awayFrom(position.x, offset.x), awayFrom(position.y, offset.y),
            awayFrom(position.z, offset.z)};
}

inline V3 intoHemisphere(V3 direction, V3 normal) {
    const F64 height = dot(direction, normal);
    return select(height < 0, direction - normal * (2 * height), direction);
}

/// Of vectors about as long as 1.
inline V3 unit(V3 v) { return v / squareRoot(dot(v, v)); }

/// Signs and largest component: what the rays of one bundle of the octree have in common.
inline I64 groupOf(V3 direction) {
    const V3 size = magnitude(direction);
    const I64 xIsLargest = (size.x > size.y) & (size.x > size.z);
    const I64 yIsLargest = ~(size.x > size.y) & (size.y > size.z);
    const I64 axis = ~xIsLargest & (2 + yIsLargest); // true is -1
    return axis << 3 | ((bitsOf(direction.x) < 0) & 4) | ((bitsOf(direction.y) < 0) & 2) |
           ((bitsOf(direction.z) < 0) & 1);
}

using Rgb = numeric::LinearRgb;

/// The materials of some encounters, which are sorted by them.
struct Materials {
    const material::Material* const* of;
    bool areOne;

    Materials(const Wave& w, std::size_t i) : of(w.material + i), areOne(true) {
        for (std::size_t k = 1; k < kLanes; ++k) areOne &= of[k] == of[0];
    }
    V3 operator()(Rgb material::Material::*color) const {
        const Rgb& first = of[0]->*color;
        V3 v = {all(first.r), all(first.g), all(first.b)};
        if (areOne) return v;
        for (std::size_t k = 1; k < kLanes; ++k) {
            const Rgb& c = of[k]->*color;
            v.x[k] = c.r, v.y[k] = c.g, v.z[k] = c.b;
        }
        return v;
    }
    F64 operator()(double material::Material::*number) const {
        F64 v = all(of[0]->*number);
        if (areOne) return v;
        for (std::size_t k = 1; k < kLanes; ++k) v[k] = of[k]->*number;
        return v;
    }
};

/// Writes the first `count` of some rays.
inline void store(geometry::Ray* to, std::size_t count, V3 origin, double tMax, V3 direction,
                  I64 exclude) {
    static_assert(sizeof(geometry::Ray) == 8 * sizeof(double) &&
                  __builtin_offsetof(geometry::Ray, tMax) == 3 * sizeof(double) &&
                  __builtin_offsetof(geometry::Ray, direction) == 4 * sizeof(double) &&
                  __builtin_offsetof(geometry::Ray, exclude) == 7 * sizeof(double));
    F64 rows[8] = {origin.x,    origin.y,    origin.z,    all(tMax),
                   direction.x, direction.y, direction.z, ofBits(exclude)};
    for (std::size_t part = 0; part < 8; part += kLanes) {
        transpose(rows + part);
        for (std::size_t k = 0; k < kLanes && k < count; ++k)
            storeTo(reinterpret_cast<double*>(to + k) + part, rows[part + k]);
    }
}

inline void store(Leaving& to, const Wave& w, std::size_t i, V3 origin, double tMax, V3 direction) {
    store(to.group, i, groupOf(direction));
    store(to.ray + i, kLanes, origin, tMax, direction, load(w.exclude, i));
}

bool through(const Pinhole& camera, const PicturePoint* points, std::size_t count,
             geometry::Ray* rays) {
    const auto vector = [](const numeric::Vec3& v) { return V3{all(v.x), all(v.y), all(v.z)}; };
    const V3 eye = vector(camera.eye), toScreen = vector(camera.toScreen), up = vector(camera.up),
             left = vector(camera.left);
    // As numeric::unit has it.
    constexpr double kLeast =
        std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();
    const I64 none = I64{} + static_cast<std::uint32_t>(geometry::kNoPrimitive);
    for (std::size_t i = 0; i < count; i += kLanes) {
        F64 column, row;
        for (std::size_t k = 0; k < kLanes; ++k) {
            const PicturePoint& point = points[i + k < count ? i + k : count - 1];
            column[k] = point.column, row[k] = point.row;
        }
        const V3 toSample = toScreen + up * (camera.pixelHeight * (camera.halfRows - row)) +
                            left * (camera.pixelWidth * (camera.halfColumns - column));
        const F64 squared = dot(toSample, toSample);
        if (any(~((squared > kLeast) & (squared < __builtin_inf())))) return false;
        store(rays + i, count - i, camera.startsOnScreen ? eye + toSample : eye, __builtin_inf(),
              toSample / squareRoot(squared), none);
    }
    return true;
}

/// Of what has three doubles and then some, for the rays of some encounters.
template <class T> inline V3 loadThree(const T* of, const std::uint32_t* number) {
    static_assert(sizeof(T) >= 4 * sizeof(double));
    const void* at[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) at[k] = of + number[k];
    F64 column[4];
    loadFours(at, column);
    return {column[0], column[1], column[2]};
}

/// The spheres among some encounters.
struct Spheres {
    I64 are; // mask; the others have garbage
    V3 center;
    F64 radius;

    Spheres(const Wave& w, std::size_t i) {
        are =
            *reinterpret_cast<const I64*>(w.sphere + i) != reinterpret_cast<long long>(&kNoSphere);
        if (!any(are)) return;
        const void* at[kLanes];
        for (std::size_t k = 0; k < kLanes; ++k) at[k] = w.sphere[i + k];
        static_assert(sizeof(geometry::Sphere) == 4 * sizeof(double));
        F64 column[4];
        loadFours(at, column);
        center = {column[0], column[1], column[2]};
        radius = column[3];
    }
};

bool gather(Wave& w, std::size_t count, const geometry::Ray* rays, const geometry::Hit* hits,
            const Work* works) {
    static_assert(__builtin_offsetof(Work, weight) == 0);
    bool anyExtreme = false;
    for (std::size_t i = 0; i < count; i += kLanes) {
        const std::uint32_t* const number = w.ray + i;
        F64 ray[8];
        for (std::size_t part = 0; part < 8; part += kLanes) {
            for (std::size_t k = 0; k < kLanes; ++k)
                ray[part + k] = loadFrom(reinterpret_cast<const double*>(rays + number[k]) + part);
            transpose(ray + part);
        }
        const V3 direction = {ray[4], ray[5], ray[6]};
        store(w.direction, i, direction);
        store(w.weight, i, loadThree(works, number));
        store(w.color, i, Materials(w, i)(&material::Material::color));
        const Spheres spheres(w, i);
        if (!any(spheres.are)) continue;
        F64 t;
        for (std::size_t k = 0; k < kLanes; ++k) t[k] = hits[number[k]].t;
        const V3 origin = {ray[0], ray[1], ray[2]};
        const V3 fromCenter = (origin - spheres.center) + direction * t;
        const V3 size = magnitude(fromCenter);
        const F64 largest = larger(size.x, larger(size.y, size.z));
        constexpr double kLeast = numeric::powerOfTwo(-1000), kMost = numeric::powerOfTwo(1000);
        anyExtreme |= any(spheres.are & ~((largest > kLeast) & (largest < kMost)));
        store(w.geometric, i, select(spheres.are, fromCenter, load(w.geometric, i)));
    }
    return anyExtreme;
}

void face(Wave& w, std::size_t count) {
    const V3 none = {all(0.0), all(0.0), all(0.0)};
    for (std::size_t i = 0; i < count; i += kLanes) {
        V3 geometric = load(w.geometric, i), normal = load(w.normal, i);
        F64 error = load(w.error, i), beside = load(w.errorBeside, i);
        const Spheres spheres(w, i);
        if (any(spheres.are)) {
            const V3 size = magnitude(geometric);
            const I64 exponent = bitsOf(larger(size.x, larger(size.y, size.z))) >> 52;
            const V3 scaled = geometric * ofBits((2046 - exponent) << 52);
            const V3 n = scaled * (1 / squareRoot(dot(scaled, scaled)));
            store(w.position, i,
                  select(spheres.are, spheres.center + n * spheres.radius, load(w.position, i)));
            geometric = select(spheres.are, n, geometric);
            normal = select(spheres.are, n, normal);
            constexpr double kOfCenter = numeric::gamma(2), kOfRadius = numeric::gamma(12);
            error = select(spheres.are,
                           kOfCenter * dot(magnitude(n), magnitude(spheres.center)) +
                               kOfRadius * spheres.radius,
                           error);
            beside = select(spheres.are, error, beside);
        }
        const I64 leaving = dot(load(w.direction, i), geometric) > 0;
        store(w.leaving, i, leaving);
        store(w.geometric, i, select(leaving, -geometric, geometric));
        store(w.normal, i, select(leaving, -normal, normal));
        // Rays leave from beyond a second surface that coincides with this one: its bound too.
        store(w.error, i, error + beside);
        store(w.light, i, none);
    }
}

void aim(Wave& w, std::size_t count, const double light[3]) {
    const V3 none = {all(0.0), all(0.0), all(0.0)};
    const V3 at = {all(light[0]), all(light[1]), all(light[2])};
    for (std::size_t i = 0; i < count; i += kLanes) {
        const V3 position = load(w.position, i), normal = load(w.normal, i);
        const V3 toLight = at - position;
        const F64 squared = dot(toLight, toLight);
        const V3 direction = toLight / squareRoot(squared);
        const F64 cosine = dot(direction, normal);
        store(w.cosine, i, select(squared > 0, select(cosine > 0, cosine, all(0.0)), all(-1.0)));
        const V3 halfway = direction - load(w.direction, i);
        store(w.halfway, i, dot(halfway, normal) / squareRoot(dot(halfway, halfway)));
        const V3 origin = spawnOrigin(position, load(w.geometric, i), load(w.leaving, i),
                                      load(w.error, i), toLight);
        store(w.shadow, w, i, origin, 1, at - origin);
        store(w.visible, i, none);
    }
}

inline I64 isBlack(V3 c) { return (c.x == 0) & (c.y == 0) & (c.z == 0); }

void add(Wave& w, std::size_t count, bool transmits) {
    for (std::size_t i = 0; i < count; i += kLanes) {
        const F64 cosine = load(w.cosine, i), halfway = load(w.halfway, i);
        const Materials materials(w, i);
        const V3 specular = materials(&material::Material::specular);
        V3 visible = load(w.visible, i);
        if (transmits)
            visible = select(cosine == 0, visible * materials(&material::Material::transmission),
                             visible);
        const I64 shines = (cosine > 0) & (halfway > 0) & ~isBlack(specular) & ~isBlack(visible);
        F64 highlight = all(0.0);
        if (any(shines))
            highlight = select(shines,
                               power(select(shines & (halfway < 1), halfway, all(1.0)),
                                     materials(&material::Material::shininess)),
                               highlight);
        const V3 added =
            (materials(&material::Material::environment) * visible +
             load(w.color, i) * materials(&material::Material::diffuse) * cosine * visible) +
            specular * highlight * visible;
        store(w.visible, i, visible);
        store(w.added, i, added);
        store(w.light, i, load(w.light, i) + added);
    }
}

void bend(Wave& w, std::size_t first, std::size_t count) {
    for (std::size_t i = first / kLanes * kLanes; i < count; i += kLanes) {
        const F64 ior = Materials(w, i)(&material::Material::ior);
        const F64 ratio = select(load(w.leaving, i), ior, 1 / ior);
        store(w.ratio, i, select(load(w.bends, i), ratio, all(1.0)));
        store(w.refractedError, i, load(w.error, i));
    }
}

/// What is mirrored, from encounter `first` on, and what is let through, from `transmitters` on.
void leave(Wave& w, std::size_t first, std::size_t transmitters, std::size_t count) {
    const V3 none = {all(0.0), all(0.0), all(0.0)};
    for (std::size_t i = first / kLanes * kLanes; i < count; i += kLanes) {
        const V3 direction = load(w.direction, i), geometric = load(w.geometric, i);
        const V3 position = load(w.position, i), shading = load(w.normal, i);
        const V3 weight = load(w.weight, i), color = load(w.color, i);
        const I64 leaving = load(w.leaving, i);
        const Materials materials(w, i);
        V3 share = materials(&material::Material::specular);
        const I64 mirrors = ~isBlack(share);
        I64 reflects = mirrors, sends = mirrors & Sends::kMirrors;
        if (i + kLanes > transmitters) {
            const F64 ratio = load(w.ratio, i);
            // An interpolated normal may point away from the viewer.
            const V3 normal = select(dot(direction, shading) < 0, shading, geometric);
            const V3 tangential = (direction - normal * dot(direction, normal)) * ratio;
            const F64 sineSquared = dot(tangential, tangential);
            const V3 bent = unit(tangential - normal * squareRoot(1 - sineSquared));
            const I64 straight = ratio == 1, passes = straight | (sineSquared < 1);
            const V3 out = select(straight, direction, -intoHemisphere(-bent, geometric));
            const V3 transmission = materials(&material::Material::transmission);
            store(w.refracted, w, i,
                  spawnOrigin(position, geometric, leaving, load(w.refractedError, i), out),
                  __builtin_inf(), out);
            const V3 refracted = weight * (color * transmission);
            store(w.refractedWeight, i, refracted);
            share = share + select(passes, none, transmission);
            const I64 clear = ~isBlack(transmission);
            reflects |= clear & ~passes;
            sends |=
                (clear & passes & Sends::kRefracts) | (isBlack(refracted) & Sends::kRefractedBlack);
        }
        const V3 out =
            intoHemisphere(unit(direction - shading * (2 * dot(direction, shading))), geometric);
        store(w.mirrored, w, i, spawnOrigin(position, geometric, leaving, load(w.error, i), out),
              __builtin_inf(), out);
        const V3 mirrored = weight * (color * share);
        store(w.mirroredWeight, i, mirrored);
        store(w.sends, i,
              sends | (reflects & Sends::kReflects) | (isBlack(mirrored) & Sends::kReflectedBlack));
    }
}
