// SPDX-License-Identifier: BSD-3-Clause
#include "oracle/root.h"

#include <cmath>
#include <cstdint>
#include <cstring>

static void trim(polynomial &f)
{
    while (!f.empty() && !sgn(f.back()))
        f.pop_back();
}

polynomial operator+(const polynomial &a, const polynomial &b)
{
    polynomial sum = a.size() < b.size() ? b : a;
    const polynomial &less = a.size() < b.size() ? a : b;
    for (size_t i = 0; i < less.size(); i++)
        sum[i] += less[i];
    trim(sum);
    return sum;
}

polynomial operator-(const polynomial &a, const polynomial &b)
{
    polynomial minus = b;
    for (mpz_class &c : minus)
        c = -c;
    return a + minus;
}

polynomial operator*(const polynomial &a, const polynomial &b)
{
    if (a.empty() || b.empty())
        return polynomial();
    polynomial product(a.size() + b.size() - 1);
    for (size_t i = 0; i < a.size(); i++)
        for (size_t j = 0; j < b.size(); j++)
            product[i + j] += a[i] * b[j];
    return product;
}

static void make_primitive(polynomial &f)
{
    mpz_class content = 0;
    for (const mpz_class &c : f)
        content = gcd(content, c);
    for (mpz_class &c : f)
        mpz_divexact(c.get_mpz_t(), c.get_mpz_t(), content.get_mpz_t());
}

// The remainder of some multiple of f.
static polynomial remainder_of(polynomial f, const polynomial &divisor)
{
    while (f.size() >= divisor.size()) {
        const size_t shift = f.size() - divisor.size();
        const mpz_class lead = f.back();
        for (mpz_class &c : f)
            c *= divisor.back();
        for (size_t i = 0; i < divisor.size(); i++)
            f[shift + i] -= lead * divisor[i];
        trim(f);
    }
    return f;
}

polynomial common_divisor(polynomial a, polynomial b)
{
    make_primitive(a);
    make_primitive(b);
    while (!b.empty()) {
        polynomial rest = a.size() < b.size() ? a : remainder_of(a, b);
        make_primitive(rest);
        a.swap(b);
        b.swap(rest);
    }
    return a;
}

// f without its multiple roots: by Gauss's lemma the quotient of two primitive polynomials is whole.
static polynomial each_root_once(polynomial f)
{
    make_primitive(f);
    polynomial slope;
    for (size_t i = 1; i < f.size(); i++)
        slope.push_back(f[i] * (unsigned long)i);
    const polynomial divisor = common_divisor(f, slope);
    polynomial quotient(f.size() - divisor.size() + 1);
    for (size_t i = quotient.size(); i-- > 0;) {
        mpz_divexact(quotient[i].get_mpz_t(), f[i + divisor.size() - 1].get_mpz_t(),
                     divisor.back().get_mpz_t());
        for (size_t j = 0; j < divisor.size(); j++)
            f[i + j] -= quotient[i] * divisor[j];
    }
    return quotient;
}

// The sign at m / 2^k.
static int sign_there(const polynomial &f, const mpz_class &m, unsigned long k)
{
    mpz_class sum = 0;
    for (size_t i = f.size(), bits = 0; i-- > 0; bits += k)
        sum = sum * m + (f[i] << bits);
    return sgn(sum);
}

static void shift_by(std::vector<mpz_class> &f, const mpz_class &way)
{
    for (size_t i = 0; i < f.size(); i++)
        for (size_t j = f.size() - 1; j-- > i;)
            f[j] += way * f[j + 1];
}

// Of f between m / 2^k and (m + 1) / 2^k, both not included.
struct outlook {
    int changes; // 0: no root, 1: one and a simple one; more: as many or fewer by an even number
    int first;   // the sign just after m / 2^k
};

// Descartes' rule of signs: the interval is taken to the positive numbers.
static outlook look(const polynomial &f, const mpz_class &m, unsigned long k)
{
    std::vector<mpz_class> g(f.size());
    for (size_t i = 0; i < f.size(); i++)
        g[i] = f[i] << (k * (f.size() - 1 - i));
    if (sgn(m))
        shift_by(g, m);
    for (size_t i = 0; 2 * i + 1 < g.size(); i++)
        swap(g[i], g[g.size() - 1 - i]);
    shift_by(g, 1);
    outlook seen = { 0, 0 };
    int last = 0;
    for (size_t i = g.size(); i-- > 0;) {
        const int sign = sgn(g[i]);
        seen.changes += sign && last && sign != last;
        seen.first = seen.first ? seen.first : sign;
        last = sign ? sign : last;
    }
    return seen;
}

static void add_roots(const polynomial &p, const mpz_class &m, unsigned long k,
                      std::vector<moment> &roots)
{
    const outlook seen = look(p, m, k);
    if (seen.changes == 1)
        roots.push_back({ p, m, k, seen.first });
    if (seen.changes <= 1)
        return;
    const mpz_class middle = 2 * m + 1;
    if (!sign_there(p, middle, k + 1))
        roots.push_back({ p, middle, k + 1, 0 });
    add_roots(p, 2 * m, k + 1, roots);
    add_roots(p, middle, k + 1, roots);
}

std::vector<moment> roots_of(const polynomial &f)
{
    std::vector<moment> roots;
    const int changes = f.empty() ? 0 : look(f, 0, 0).changes;
    if (changes)
        add_roots(changes == 1 ? f : each_root_once(f), 0, 0, roots);
    return roots;
}

static void halve(moment &when)
{
    when.m *= 2;
    when.k++;
    const int middle = sign_there(when.p, when.m + 1, when.k);
    if (!middle || middle == when.before)
        when.m += 1;
    if (!middle)
        when.before = 0;
}

int sign_at(const polynomial &f, moment &when)
{
    enum { PATIENCE = 5 }; // so often it is halved before a common root is thought of
    for (int i = 0; when.before && !f.empty(); i++) {
        const outlook seen = look(f, when.m, when.k);
        if (!seen.changes)
            return seen.first;
        if (i == PATIENCE) {
            // The moment is its only root here, if it has one, and a simple one.
            const polynomial common = common_divisor(when.p, f);
            if (look(common, when.m, when.k).changes % 2)
                return 0;
        }
        halve(when);
    }
    return f.empty() ? 0 : sign_there(f, when.m, when.k);
}

// The sign of when - m / 2^k.
static int order(const moment &when, const mpz_class &m, unsigned long k)
{
    const int low = cmp(when.m << k, m << when.k);
    if (!when.before)
        return low;
    if (low >= 0)
        return 1;
    if (cmp((when.m + 1) << k, m << when.k) <= 0)
        return -1;
    const int sign = sign_there(when.p, m, k);
    return sign == when.before ? 1 : sign ? -1 : 0;
}

// Bisects the doubles by their bits, which are in the order of their values.
void doubles_around(const moment &when, double *low, double *high)
{
    uint64_t least = 0, most = 0;
    *low = 0.0;
    *high = 1.0;
    memcpy(&most, high, sizeof most);
    while (most - least > 1) {
        const uint64_t bits = least + (most - least) / 2;
        double middle;
        int exponent;
        memcpy(&middle, &bits, sizeof middle);
        const mpz_class m = ldexp(frexp(middle, &exponent), 53);
        const int later = order(when, m, (unsigned long)(53 - exponent));
        if (later >= 0)
            least = bits, *low = middle;
        if (later <= 0)
            most = bits, *high = middle;
        if (!later)
            return;
    }
}
