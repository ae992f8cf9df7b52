// numeric::pow(x, y) of lanes 0 < x <= 1, y >= 0: elementary.cpp operation by operation, which derives it.

struct D2 {
    F64 hi, lo;
};

inline D2 quickTwoSum(F64 a, F64 b) {
    const F64 sum = a + b;
    return {sum, b - (sum - a)};
}
inline D2 twoSum(F64 a, F64 b) {
    const F64 sum = a + b, bShare = sum - a;
    return {sum, (a - (sum - bShare)) + (b - bShare)};
}
inline D2 split(F64 a) {
    const F64 scaled = a * 0x1p27 + a;
    const F64 hi = scaled - (scaled - a);
    return {hi, a - hi};
}
inline D2 twoProduct(F64 a, F64 b) {
    const D2 x = split(a), y = split(b);
    const F64 product = a * b;
    return {product, ((x.hi * y.hi - product) + x.hi * y.lo + x.lo * y.hi) + x.lo * y.lo};
}

constexpr double kRoundShift = 0x1.8p52; // see elementary.cpp
constexpr long long kBitsOfRoundShift = 0x4338000000000000;

/// To and from integers below 2^51.
inline F64 rounded(I64 n) { return ofBits(n + kBitsOfRoundShift) - kRoundShift; }
inline I64 integer(F64 rounded) { return bitsOf(rounded + kRoundShift) - kBitsOfRoundShift; }

/// 2^n of normal numbers.
inline F64 powerOfTwo(I64 n) { return ofBits((n + 1023) << 52); }

/// Of normal x > 0.
inline D2 logarithm(F64 x) {
    const I64 bits = bitsOf(x), above = bits - static_cast<long long>(numeric::kLogStart);
    const F64 k = rounded(above >> 52);
    F64 inverse, stepHi, stepLo;
    for (std::size_t i = 0; i < kLanes; ++i) {
        const numeric::LogTable::Step& step = numeric::kLog.at[(above[i] >> 45) & 127];
        inverse[i] = step.inverse, stepHi[i] = step.hi, stepLo[i] = step.lo;
    }
    const F64 m = ofBits(bits - (above & (0xfffll << 52)));
    const F64 mHi = ofBits(bitsOf(m) & ~0x7ffffffll);
    const D2 r = twoSum(mHi * inverse - 1, (m - mHi) * inverse);

    const D2 square = twoProduct(r.hi, r.hi);
    const D2 quadratic = quickTwoSum(r.hi, -0.5 * square.hi);
    const F64 t = r.hi, tt = square.hi;
    const F64 tail = (1.0 / 3 - t * (1.0 / 4)) +
                     tt * ((1.0 / 5 - t * (1.0 / 6)) +
                           tt * ((1.0 / 7 - t * (1.0 / 8)) + tt * (1.0 / 9 - t * (1.0 / 10))));
    const F64 low = quadratic.lo + ((r.lo - 0.5 * square.lo - t * r.lo) + t * tt * tail);

    const D2 sum = twoSum(k * numeric::kLog.ln2Hi + stepHi, quadratic.hi);
    return quickTwoSum(sum.hi, sum.lo + (low + (stepLo + k * numeric::kLog.ln2Lo)));
}

/// Of x <= 0.
inline F64 exponential(D2 x) {
    const I64 vanishes = ~(x.hi > -746);
    const F64 hi = select(vanishes, all(0.0), x.hi);
    const F64 n = (hi * 0x1.71547652b82fep+7 + kRoundShift) - kRoundShift;
    const F64 r = ((hi - n * numeric::kExp.stepHi) - n * numeric::kExp.stepLo) + x.lo;
    const F64 p = r + r * r * (0.5 + r * (1.0 / 6 + r * (1.0 / 24 + r * (1.0 / 120))));
    const I64 steps = integer(n);
    F64 baseHi, baseLo;
    for (std::size_t i = 0; i < kLanes; ++i) {
        const numeric::ExpTable::Step& base = numeric::kExp.at[steps[i] & (numeric::kExpSteps - 1)];
        baseHi[i] = base.hi, baseLo[i] = base.lo;
    }
    // In two factors, of which only the second can round.
    const I64 exponent = steps >> 7, half = exponent >> 1;
    const F64 scaled =
        (baseHi + (baseLo + baseHi * p)) * powerOfTwo(half) * powerOfTwo(exponent - half);
    return select(vanishes, all(0.0), scaled);
}

inline F64 power(F64 x, F64 y) {
    const I64 subnormal = x < 0x1p-1022;
    const D2 log = logarithm(select(subnormal, all(1.0), x));
    D2 product = twoProduct(log.hi, y);
    product.lo = product.lo + log.lo * y;
    F64 result = select((x == 1) | (y == 0), all(1.0), exponential(product));
    const I64 special = subnormal | ~(y < 0x1p64);
    if (any(special))
        for (std::size_t i = 0; i < kLanes; ++i)
            if (special[i]) result[i] = numeric::pow(x[i], y[i]);
    return result;
}
