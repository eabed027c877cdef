//! Coordinates: names, families, topology, limits.

use dalembert_expr::Assumption as Known;

use super::super::resolve::{Resolver, Scope};
use super::super::symbols::{Meaning, coordinate_symbols, member_name};
use super::super::{Coordinate, Topology};
use crate::spec::{self, COORDINATES, Declared, Index};

impl<'s> Resolver<'s> {
    /// All coordinates, families expanded.
    pub(super) fn all_coordinates(&mut self) {
        let spec = self.spec;
        if spec.coordinates.is_empty() {
            self.refuse::<()>(
                spec.name.at,
                "a model needs at least one coordinate",
                "write `coordinates { x; theta: angle; }`",
            );
        }
        for coordinate in &spec.coordinates {
            self.coordinate_family(coordinate);
        }
    }

    fn coordinate_family(&mut self, written: &'s spec::Coordinate) {
        let topology = self.topology(written);
        let first = self.symbols.coordinates.len();
        let size = self.family_size(&written.declared, first, COORDINATES, "coordinates");
        let meaning = size.map_or(Meaning::Coordinate(first), |size| {
            Meaning::Coordinates(first, size)
        });
        if !self.declare(&written.declared.name, meaning) {
            return;
        }
        let members: Vec<Option<usize>> =
            size.map_or(vec![None], |size| (1..=size).map(Some).collect());
        for member in members {
            self.new_coordinate(written, member, topology);
        }
    }

    fn new_coordinate(
        &mut self,
        written: &spec::Coordinate,
        member: Option<usize>,
        topology: Topology,
    ) {
        let name = member_name(&written.declared.name.text, member);
        let known = self.known(topology);
        let [q, qdot, differential, momentum] = coordinate_symbols(&mut self.pool, &name, known);
        self.symbols.coordinates.push(Coordinate {
            name,
            documentation: written.documentation.clone(),
            topology,
            q,
            qdot,
            item: written.item,
        });
        self.symbols.differentials.push(differential);
        self.symbols.derived.momenta.push(momentum);
    }

    /// Sign of a coordinate that follows from its interval.
    fn known(&self, topology: Topology) -> Known {
        match topology {
            Topology::Interval { low, .. } if self.constant_value(low) >= 0.0 => Known::Positive,
            Topology::Interval { high, .. } if self.constant_value(high) <= 0.0 => Known::NonZero,
            _ => Known::None,
        }
    }

    fn topology(&mut self, written: &spec::Coordinate) -> Topology {
        match &written.topology {
            spec::Topology::Line => Topology::Line,
            spec::Topology::Angle => Topology::Angle,
            spec::Topology::Interval(ends) => {
                let [low, high] = ends.as_ref();
                let ends = (
                    self.constant_expression(low, "the end of an interval"),
                    self.constant_expression(high, "the end of an interval"),
                );
                let (Some(low_value), Some(high_value)) = ends else {
                    return Topology::Line;
                };
                if self.constant_value(low_value) >= self.constant_value(high_value) {
                    let at = low.at.to(high.at);
                    self.refuse::<()>(
                        at,
                        format!("the interval from `{low}` to `{high}` is empty"),
                        "write `(low, high)`",
                    );
                }
                Topology::Interval {
                    low: low_value,
                    high: high_value,
                }
            }
        }
    }

    /// Number of members of a declared family; `None` for a single name. A family whose size is wrong gets one member,
    /// so that its name is still known. `present` is the number of members that were declared before.
    pub(super) fn family_size(
        &mut self,
        declared: &Declared,
        present: usize,
        limit: usize,
        what: &str,
    ) -> Option<usize> {
        let size = declared
            .index
            .as_ref()
            .map(|index| self.written_size(declared, index).unwrap_or(1));
        let total = present + size.unwrap_or(1);
        if total <= limit {
            return size;
        }
        let text = format!("{total} {what}; the limit is {limit}");
        self.refuse::<()>(declared.name.at, text, "split the model");
        // Some members beyond the limit are known, so that their uses are not reported as well.
        size.map(|size| size.min(4 * limit))
    }

    fn written_size(&mut self, declared: &Declared, index: &Index) -> Option<usize> {
        let size = match index {
            Index::One(size) => size,
            Index::Each(binder) => {
                let help = format!("write `{}[{}]`", declared.name.text, binder.high);
                return self.refuse(binder.name.at, "a family is declared by its size", &help);
            }
        };
        let count = self.integer(size, &mut Scope::default())?;
        match usize::try_from(count) {
            Ok(count) if count > 0 => Some(count),
            _ => self.refuse(
                size.at,
                format!("a family of {count}"),
                "a family has at least one member",
            ),
        }
    }
}
