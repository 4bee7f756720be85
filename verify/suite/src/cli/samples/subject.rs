//! What points are held against: a domain, its density and its atoms, behind one interface for any number of coordinates.

use verify::chi_square::{ChiSquare, Target};
use verify::claim::Evidence;
use verify::cube::Cube;
use verify::domain::{Domain, EDGE_ROUNDING};
use verify::error::InputError;
use verify::histogram::Histogram;

/// The density that points should have.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Pdf {
    /// The same everywhere.
    Uniform,
    /// cos θ/π about +z.
    Cosine,
    /// Constant on cells: columns and rows, values row by row.
    Cells([usize; 2], Vec<f64>),
}

/// A point with a probability of its own.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Atom {
    pub(super) place: Vec<f64>,
    pub(super) probability: f64,
}

/// A test that takes points as rows of numbers.
pub(super) trait Subject {
    /// Counts points, one after the other in `values`.
    fn add(&mut self, values: &[f64]);

    /// Tests what was counted.
    fn judge(&self, bound: f64) -> Result<Evidence, InputError>;
}

/// Points of `N` coordinates on a domain.
struct OnDomain<D: Domain, const N: usize> {
    target: Target<D>,
    histogram: Histogram,
    atoms: Vec<[f64; N]>,
    point: fn([f64; N]) -> D::Point,
}

/// A test on a domain.
///
/// * `point`: the domain's point from its coordinates.
///
/// # Errors
/// A message for a cosine density on points that are no directions, or atoms of other coordinates.
pub(super) fn on_domain<D: Domain, const N: usize>(
    domain: D,
    point: fn([f64; N]) -> D::Point,
    coordinates: impl Fn(D::Point) -> [f64; N] + Send + Sync + 'static,
    (pdf, atoms): (&Pdf, &[Atom]),
) -> Result<Box<dyn Subject>, String> {
    let target = ChiSquare::on(domain);
    let target = match pdf {
        Pdf::Uniform => target,
        Pdf::Cosine if N == 3 => {
            target.density(move |p| coordinates(p)[2].max(0.0) * std::f64::consts::FRAC_1_PI)
        }
        Pdf::Cosine => return Err(String::from("--pdf cosine: domains of directions are accepted")),
        Pdf::Cells(shape, values) => target.cells(*shape, values.clone()),
    };
    let probabilities: Vec<f64> = atoms.iter().map(|atom| atom.probability).collect();
    let place = |atom: &Atom| {
        let given = atom.place.len();
        <[f64; N]>::try_from(atom.place.clone())
            .map_err(|_| format!("--atom: a place of {given} coordinates; {N} are accepted"))
    };
    let target = target.atoms(&probabilities);
    let histogram = target.histogram();
    let atoms = atoms.iter().map(place).collect::<Result<_, _>>()?;
    Ok(Box::new(OnDomain { target, histogram, atoms, point }))
}

impl<D: Domain, const N: usize> Subject for OnDomain<D, N> {
    fn add(&mut self, values: &[f64]) {
        for &row in values.as_chunks::<N>().0 {
            match self.atoms.iter().position(|atom| is_at(atom, &row)) {
                Some(atom) => self.histogram.add_atom(atom),
                None => self.target.add(&mut self.histogram, (self.point)(row)),
            }
        }
    }

    fn judge(&self, bound: f64) -> Result<Evidence, InputError> {
        self.target.judge(&self.histogram, bound)
    }
}

/// Whether a point is at an atom, but for the rounding of single precision.
fn is_at<const N: usize>(atom: &[f64; N], point: &[f64; N]) -> bool {
    atom.iter().zip(point).all(|(a, x)| (a - x).abs() <= EDGE_ROUNDING * (1.0 + a.abs()))
}

/// Points of a cube, through their projections.
pub(super) struct OnCube {
    pub(super) cube: Cube,
    pub(super) dimensions: usize,
}

impl Subject for OnCube {
    fn add(&mut self, values: &[f64]) {
        values.chunks_exact(self.dimensions).for_each(|point| self.cube.add(point));
    }

    fn judge(&self, bound: f64) -> Result<Evidence, InputError> {
        self.cube.judge(bound)
    }
}
