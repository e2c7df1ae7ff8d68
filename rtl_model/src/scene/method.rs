//! The traversals, by the names that files and the command line use.

use std::fmt;
use std::str::FromStr;

use serde::Deserialize;

use super::WalkError;
use crate::units::search_policy::{Ascent, SearchPolicy, Start};

/// A traversal. `docs/traversals.md` compares them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(try_from = "String")]
pub enum Method {
    /// Texel by texel over the map, no pyramid: the yardstick.
    Texel,
    /// From the root of the pyramid downwards, never up again (Oh, Ki and Lee 2006).
    Oh,
    /// As `oh`, and a level up at every second border (Tevs, Ihrke and Seidel 2008).
    Tevs,
    /// As `oh`, and a level up at every border (Drobot 2010).
    Drobot,
    /// As `oh`, from the lowest node that holds the whole ray (the 2013 hardware paper, 3.1).
    StartLevel,
    /// As `oh`, so many levels down at once until the first crossing, 1 to 4 (the same, 3.2).
    MultiLevelDown(u32),
    /// As `tevs`, but not up where the ray is sure to end in the neighbour (the same, 3.3).
    SelectiveUp,
    /// A level up at the second crossing in a row at a level (the same, 3.3).
    CoherentUp,
    /// Start level, two levels down and selective up together (the same, 5.3).
    MixedSelective,
    /// Start level, two levels down and coherent up together (the same, 5.3).
    MixedCoherent,
    /// The four children of a node are read as one word and looked at in one step.
    Quad,
    /// A line of 4 x 4 grandchildren is read as one word and looked at in one step.
    Block,
    /// The 4 x 4 nodes from the ray's own on are read at once, from sixteen banks, and looked at in
    /// one step.
    Window,
    /// As `quad`, by bounds of the depths of borders, with neither divider nor multiplier in a step. In
    /// fixed point only.
    BoundedQuad,
    /// As `block`, likewise.
    BoundedBlock,
    /// Linear steps, then binary ones (Policarpo, Oliveira and Comba 2005). May miss.
    Relief,
    /// Linear steps over a piecewise-linear profile, then a secant (Tatarchuk 2006). May miss.
    Pom,
    /// A search confined to the depths that the corner rays of a pixel block found (Judnich and
    /// Ling, depth-interval grids). May miss; needs a frame.
    Dig,
}

/// What kind of step a method takes, with all that tells it from others of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// A node of the pyramid a step.
    Nodes(SearchPolicy),
    /// A word of several nodes a step: `2^log2_side` nodes on a side.
    Wide {
        /// 1: the four children; 2: the sixteen grandchildren.
        log2_side: u32,
    },
    /// A window of 4 x 4 nodes a step, from the ray's own node on.
    Window,
    /// A word of several nodes a step, compared with bounds; in fixed point only.
    Bounded {
        /// As of [`Family::Wide`].
        log2_side: u32,
    },
    /// Samples along the ray, with no promise not to miss.
    Linear(LinearSearch),
}

/// The methods that sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LinearSearch {
    /// Relief mapping.
    Relief,
    /// Parallax occlusion mapping.
    Pom,
    /// Depth-interval grids.
    Dig,
}

impl Method {
    /// Those of every number format, in the order of the documentation; of the levels down, the
    /// paper's choice.
    pub const ALL: [Method; 16] = [
        Method::Texel,
        Method::Oh,
        Method::Tevs,
        Method::Drobot,
        Method::StartLevel,
        Method::MultiLevelDown(2),
        Method::SelectiveUp,
        Method::CoherentUp,
        Method::MixedSelective,
        Method::MixedCoherent,
        Method::Quad,
        Method::Block,
        Method::Window,
        Method::Relief,
        Method::Pom,
        Method::Dig,
    ];

    /// Those of fixed point alone.
    pub const FIXED_ONLY: [Method; 2] = [Method::BoundedQuad, Method::BoundedBlock];

    /// The most levels that `multi-level-down` goes at once.
    pub const MOST_LEVELS_DOWN: u32 = 4;

    /// The name in files and on the command line, but for the number of levels.
    pub const fn name(self) -> &'static str {
        match self {
            Method::Texel => "texel",
            Method::Oh => "oh",
            Method::Tevs => "tevs",
            Method::Drobot => "drobot",
            Method::StartLevel => "start-level",
            Method::MultiLevelDown(_) => "multi-level-down",
            Method::SelectiveUp => "selective-up",
            Method::CoherentUp => "coherent-up",
            Method::MixedSelective => "mixed-selective",
            Method::MixedCoherent => "mixed-coherent",
            Method::Quad => "quad",
            Method::Block => "block",
            Method::Window => "window",
            Method::BoundedQuad => "bounded-quad",
            Method::BoundedBlock => "bounded-block",
            Method::Relief => "relief",
            Method::Pom => "pom",
            Method::Dig => "dig",
        }
    }

    /// What kind of step it takes.
    pub const fn family(self) -> Family {
        const fn nodes(start: Start, levels_down: u32, ascent: Ascent) -> Family {
            Family::Nodes(SearchPolicy {
                start,
                levels_down,
                ascent,
            })
        }
        match self {
            Method::Texel => nodes(Start::Texel, 1, Ascent::Never),
            Method::Oh => nodes(Start::Root, 1, Ascent::Never),
            Method::Tevs => nodes(Start::Root, 1, Ascent::EvenBorder),
            Method::Drobot => nodes(Start::Root, 1, Ascent::Always),
            Method::StartLevel => nodes(Start::WholeRay, 1, Ascent::Never),
            Method::MultiLevelDown(levels) => nodes(Start::Root, levels, Ascent::Never),
            Method::SelectiveUp => nodes(Start::Root, 1, Ascent::Selective),
            Method::CoherentUp => nodes(Start::Root, 1, Ascent::Coherent),
            Method::MixedSelective => nodes(Start::WholeRay, 2, Ascent::Selective),
            Method::MixedCoherent => nodes(Start::WholeRay, 2, Ascent::Coherent),
            Method::Quad => Family::Wide { log2_side: 1 },
            Method::Block => Family::Wide { log2_side: 2 },
            Method::Window => Family::Window,
            Method::BoundedQuad => Family::Bounded { log2_side: 1 },
            Method::BoundedBlock => Family::Bounded { log2_side: 2 },
            Method::Relief => Family::Linear(LinearSearch::Relief),
            Method::Pom => Family::Linear(LinearSearch::Pom),
            Method::Dig => Family::Linear(LinearSearch::Dig),
        }
    }

    /// The method that walks by this policy, if it has a name.
    pub fn of(policy: SearchPolicy) -> Option<Method> {
        let levels = (1..=Method::MOST_LEVELS_DOWN).map(Method::MultiLevelDown);
        let mut named = Method::ALL.into_iter().chain(levels);
        named.find(|method| method.family() == Family::Nodes(policy))
    }

    /// Does it promise never to miss?
    pub const fn is_safe(self) -> bool {
        !matches!(self.family(), Family::Linear(_))
    }

    /// All names, for messages and help.
    pub fn list() -> String {
        let fixed_only = Method::FIXED_ONLY.map(Method::name).join(", ");
        let all = Method::ALL.map(Method::name).join(", ");
        format!("{all}; in fixed point {fixed_only}")
    }
}

impl FromStr for Method {
    type Err = WalkError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if let Some(levels) = text.strip_prefix("multi-level-down:") {
            return match levels.parse() {
                Ok(levels @ 1..=Method::MOST_LEVELS_DOWN) => Ok(Method::MultiLevelDown(levels)),
                _ => Err(WalkError::LevelsDown {
                    text: text.to_owned(),
                }),
            };
        }
        Method::ALL
            .into_iter()
            .chain(Method::FIXED_ONLY)
            .find(|method| method.name() == text)
            .ok_or_else(|| WalkError::UnknownMethod {
                text: text.to_owned(),
            })
    }
}

impl TryFrom<String> for Method {
    type Error = WalkError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Method::MultiLevelDown(levels) if *levels != 2 => {
                write!(f, "{}:{levels}", self.name())
            }
            _ => f.write_str(self.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_read_back_from_their_names() {
        let levels = (1..=Method::MOST_LEVELS_DOWN).map(Method::MultiLevelDown);
        let methods = Method::ALL.into_iter().chain(Method::FIXED_ONLY);
        for method in methods.chain(levels) {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
    }

    #[test]
    fn an_unknown_method_comes_with_the_known_ones() {
        let message = "maximum".parse::<Method>().unwrap_err().to_string();
        assert!(message.starts_with("unknown method `maximum`: there is texel, oh"));
        let message = "multi-level-down:5".parse::<Method>().unwrap_err();
        assert!(message.to_string().contains("1 to 4"), "{message}");
    }
}
