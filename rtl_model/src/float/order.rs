//! Comparisons, and the smaller and larger of two values.

use std::cmp::Ordering;
use std::fmt;

use super::{Answer, Flags, FloatArithmetic};

/// Which NaN makes a comparison invalid (IEEE 754-2019, 5.11).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Comparison {
    /// A signalling one.
    Quiet,
    /// Any: nobody who asks which of two is smaller expects one that is no number.
    Signalling,
}

impl Comparison {
    /// Both, in the order of the documentation.
    pub const ALL: [Comparison; 2] = [Comparison::Quiet, Comparison::Signalling];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Comparison::Quiet => "quiet",
            Comparison::Signalling => "signalling",
        }
    }
}

/// What can be asked of the order of two values: the predicates of IEEE 754-2019, tables 5.1 to
/// 5.3. Two values are less, equal, greater, or (where either is NaN) unordered; each relation is a
/// set of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Relation {
    /// Equal.
    Equal,
    /// Not equal: less, greater or unordered.
    NotEqual,
    /// Less.
    LessThan,
    /// Less or equal.
    LessEqual,
    /// Greater.
    GreaterThan,
    /// Greater or equal.
    GreaterEqual,
    /// Not less: greater, equal or unordered.
    NotLessThan,
    /// Neither less nor equal: greater or unordered.
    NotLessEqual,
    /// Not greater: less, equal or unordered.
    NotGreaterThan,
    /// Neither greater nor equal: less or unordered.
    NotGreaterEqual,
    /// Unordered.
    Unordered,
    /// Less, equal or greater.
    Ordered,
}

impl Relation {
    /// All twelve, in the order of the documentation.
    pub const ALL: [Relation; 12] = [
        Relation::Equal,
        Relation::NotEqual,
        Relation::LessThan,
        Relation::LessEqual,
        Relation::GreaterThan,
        Relation::GreaterEqual,
        Relation::NotLessThan,
        Relation::NotLessEqual,
        Relation::NotGreaterThan,
        Relation::NotGreaterEqual,
        Relation::Unordered,
        Relation::Ordered,
    ];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Relation::Equal => "equal",
            Relation::NotEqual => "not_equal",
            Relation::LessThan => "less_than",
            Relation::LessEqual => "less_equal",
            Relation::GreaterThan => "greater_than",
            Relation::GreaterEqual => "greater_equal",
            Relation::NotLessThan => "not_less_than",
            Relation::NotLessEqual => "not_less_equal",
            Relation::NotGreaterThan => "not_greater_than",
            Relation::NotGreaterEqual => "not_greater_equal",
            Relation::Unordered => "unordered",
            Relation::Ordered => "ordered",
        }
    }

    /// Does it hold of two values in this order, `None` being unordered?
    #[inline(always)]
    pub const fn holds(self, order: Option<Ordering>) -> bool {
        use Ordering::{Equal, Greater, Less};
        match self {
            Relation::Equal => matches!(order, Some(Equal)),
            Relation::NotEqual => !matches!(order, Some(Equal)),
            Relation::LessThan => matches!(order, Some(Less)),
            Relation::LessEqual => matches!(order, Some(Less | Equal)),
            Relation::GreaterThan => matches!(order, Some(Greater)),
            Relation::GreaterEqual => matches!(order, Some(Greater | Equal)),
            Relation::NotLessThan => !matches!(order, Some(Less)),
            Relation::NotLessEqual => !matches!(order, Some(Less | Equal)),
            Relation::NotGreaterThan => !matches!(order, Some(Greater)),
            Relation::NotGreaterEqual => !matches!(order, Some(Greater | Equal)),
            Relation::Unordered => order.is_none(),
            Relation::Ordered => order.is_some(),
        }
    }
}

impl fmt::Display for Relation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FloatArithmetic {
    /// The order of two values, `None` where either is NaN (unordered), and the flag invalid as
    /// this kind of comparison has it. Zeros are equal whatever their signs.
    #[inline]
    pub const fn compare(
        self,
        comparison: Comparison,
        a: u64,
        b: u64,
    ) -> (Option<Ordering>, Flags) {
        let order = if !self.is_ordered(a, b) {
            None
        } else if self.order_key(a) < self.order_key(b) {
            Some(Ordering::Less)
        } else if self.order_key(a) == self.order_key(b) {
            Some(Ordering::Equal)
        } else {
            Some(Ordering::Greater)
        };
        (order, self.comparison_flags(comparison, a, b))
    }

    /// Does `a` stand in this relation to `b`?
    #[inline]
    pub const fn relation(
        self,
        relation: Relation,
        comparison: Comparison,
        a: u64,
        b: u64,
    ) -> (bool, Flags) {
        let (order, flags) = self.compare(comparison, a, b);
        (relation.holds(order), flags)
    }

    // The three that stand in inner loops do not go by way of the order: it costs branches.

    /// `a == b`; false where either is NaN.
    #[inline(always)]
    pub const fn equal(self, comparison: Comparison, a: u64, b: u64) -> (bool, Flags) {
        let equal = self.is_ordered(a, b) && self.order_key(a) == self.order_key(b);
        (equal, self.comparison_flags(comparison, a, b))
    }

    /// `a < b`; false where either is NaN.
    #[inline(always)]
    pub const fn less_than(self, comparison: Comparison, a: u64, b: u64) -> (bool, Flags) {
        let less = self.is_ordered(a, b) && self.order_key(a) < self.order_key(b);
        (less, self.comparison_flags(comparison, a, b))
    }

    /// `a <= b`; false where either is NaN.
    #[inline(always)]
    pub const fn less_equal(self, comparison: Comparison, a: u64, b: u64) -> (bool, Flags) {
        let less_or_equal = self.is_ordered(a, b) && self.order_key(a) <= self.order_key(b);
        (less_or_equal, self.comparison_flags(comparison, a, b))
    }

    /// Is either NaN?
    #[inline]
    pub const fn unordered(self, comparison: Comparison, a: u64, b: u64) -> (bool, Flags) {
        self.relation(Relation::Unordered, comparison, a, b)
    }

    /// The smaller of two values: `minimumNumber` of IEEE 754-2019, 9.6.
    ///
    /// -0 is taken as smaller than +0; where one operand is NaN the result is the other, where both
    /// are the canonical NaN; a signalling NaN is invalid in either case. The result is canonical:
    /// under the policy `flush` a subnormal pattern comes out as its zero.
    #[inline]
    pub const fn min(self, a: u64, b: u64) -> Answer {
        let a_first = self.total_key(a) <= self.total_key(b);
        self.chosen(a, b, a_first)
    }

    /// The larger of two values: `maximumNumber` of IEEE 754-2019, 9.6; the rest as in
    /// [`FloatArithmetic::min`].
    #[inline]
    pub const fn max(self, a: u64, b: u64) -> Answer {
        let a_first = self.total_key(a) >= self.total_key(b);
        self.chosen(a, b, a_first)
    }

    /// `a` where it is the one wanted or the only number, else `b`.
    #[inline(always)]
    const fn chosen(self, a: u64, b: u64, a_first: bool) -> Answer {
        let format = self.format;
        let takes_a = format.is_nan(b) || (!format.is_nan(a) && a_first);
        Answer {
            bits: self.canonical(if takes_a { a } else { b }),
            flags: Flags::INVALID.when(format.is_signalling_nan(a) || format.is_signalling_nan(b)),
        }
    }

    /// Neither is NaN.
    #[inline(always)]
    const fn is_ordered(self, a: u64, b: u64) -> bool {
        !(self.format.is_nan(a) || self.format.is_nan(b))
    }

    /// Invalid where an operand is a NaN that this kind of comparison does not put up with.
    #[inline(always)]
    const fn comparison_flags(self, comparison: Comparison, a: u64, b: u64) -> Flags {
        let format = self.format;
        Flags::INVALID.when(match comparison {
            Comparison::Quiet => format.is_signalling_nan(a) || format.is_signalling_nan(b),
            Comparison::Signalling => !self.is_ordered(a, b),
        })
    }

    /// A signed integer in the order of the numbers: the magnitude, negated where the sign is 1.
    /// Both zeros have the key 0.
    #[inline(always)]
    const fn order_key(self, a: u64) -> i64 {
        let magnitude = self.read_magnitude(a) as i64;
        if self.format.has_sign(a) {
            -magnitude
        } else {
            magnitude
        }
    }

    /// As `order_key`, with -0 just below +0.
    #[inline(always)]
    const fn total_key(self, a: u64) -> i64 {
        let magnitude = self.read_magnitude(a) as i64;
        if self.format.has_sign(a) {
            !magnitude
        } else {
            magnitude
        }
    }
}
