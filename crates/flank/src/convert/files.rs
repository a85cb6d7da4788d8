//! What `flank convert` leaves in its folder: motion tables, NC programs, functions.

use flank_chain_dsl::{Dimension, NcWord};
use flank_export::{AxisSeries, Header, MachineAxis, MotionRow, MotionTable, Series, Unit, Unknown, write_nc};
use flank_expr::{Expr, Language, Polynomial, Signature, emit_function, emit_polynomials};

use super::Conversion;
use super::result::AxisMotion;
use super::table::{Named, Table};
use crate::project::choices::EmitForm;
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::requests::ConvertRequest;
use crate::project::session::Session;
use crate::project::spec::Origin;

/// Decimals of positions in NC programs: 0.1 um, and 1e-5 deg.
const DECIMALS: [u8; 2] = [4, 5];

/// Decimals of an axis's positions in NC programs.
pub(super) fn decimals(dimension: Dimension, word: &NcWord) -> u8 {
    word.decimals.unwrap_or(DECIMALS[usize::from(dimension == Dimension::ANGLE)])
}

/// Writes what is asked for and names it.
///
/// # Errors
/// In words, if a file cannot be written or a program not be made.
pub(super) fn write(
    (table, found): (&Table, &AxisMotion),
    carried: &Conversion<'_, '_>,
    header: Header,
    (request, origin, session): (&ConvertRequest, &Origin, Session<'_>),
) -> Result<Vec<String>, Failure> {
    let source = &carried.source;
    // two tools of one job do not write over each other's files
    let own = if source.is_one_of_several { format!("_{}", source.surfaces[0]) } else { String::new() };
    let name = format!("{}{own}_on_{}", table.of.job, table.of.machine);
    let motion = motion_table(table, header);
    let seconds = || request.time.expect("an NC program is asked for with its cutting time");
    // what one of the controls cannot do is an error before there is a file
    for dialect in distinct(&request.nc) {
        write_nc(&motion, dialect.into(), seconds(), &mut std::io::sink()).map_err(|error| error.to_string())?;
    }
    let mut functions = Vec::new();
    for form in distinct(&request.emit_form) {
        for language in distinct(&request.emit) {
            let (name, text) = match form {
                EmitForm::Polynomials => (name.clone(), polynomials((table, found), &name, language.into())?),
                EmitForm::Exact => {
                    let name = format!("{name}_exact");
                    let text = exact((table, found), carried, &name, language.into())?;
                    (name, text)
                }
            };
            functions.push((format!("{name}.{}", language.extension()), text));
        }
    }
    let mut folder = Folder::at(request.out(), origin, session.monitor());
    for format in distinct(request.formats()) {
        folder.motion(&name, &motion, format)?;
    }
    for dialect in distinct(&request.nc) {
        folder.nc(&name, &motion, dialect.into(), seconds())?;
    }
    functions.iter().try_for_each(|(name, text)| folder.text(name, text))?;
    folder.finish()
}

/// Each once, in their order.
fn distinct<T: Copy + PartialEq>(all: &[T]) -> Vec<T> {
    let first = |(k, one): (usize, &T)| (!all[..k].contains(one)).then_some(*one);
    all.iter().enumerate().filter_map(first).collect()
}

fn motion_table(table: &Table, mut header: Header) -> MotionTable {
    let motion = &table.motions[0];
    header.conventions.insert(0, table.carried.clone());
    header.conventions.extend(table.nc_deviation.map(|deviation| deviation.to_string()));
    let axis = |(axis, word): (&Named, &NcWord)| {
        let is_rotary = axis.dimension == Dimension::ANGLE;
        MachineAxis {
            name: axis.name.clone(),
            address: word.address.clone(),
            reversed: word.reversed,
            offset: word.offset,
            is_rotary,
            decimals: decimals(axis.dimension, word),
            travel: axis.travel.map(|(low, high)| [low, high]),
        }
    };
    let rows = table.positions.iter().zip(&table.line);
    let unit = match motion.dimension {
        Dimension::ANGLE => Unit::Degree,
        Dimension::LENGTH => Unit::Millimetre,
        _ => Unit::One,
    };
    let rates = table.rates.as_ref();
    MotionTable {
        header,
        motion: Unknown { name: motion.name.clone(), unit },
        axes: table.axes.iter().zip(&table.words).map(axis).collect(),
        rows: rows.map(|(at, posture)| MotionRow { motion: at[0], axes: posture.axes.clone() }).collect(),
        series: table.series.as_ref().map(|series| Series {
            reference: series.about,
            axes: (0..).zip(&series.axes).map(|(k, c)| axis_series(k, c, series)).collect(),
        }),
        rates: rates.map(|rates| flank_export::Rates { seconds: rates.seconds, rows: rates.rows.clone() }),
    }
}

fn axis_series(index: usize, coefficients: &[f64], series: &super::series::Series) -> AxisSeries {
    // a bound still, after the two roundings of degrees
    let remainder = series.remainders.as_ref().ok().map(|bounds| bounds[index].next_up().next_up());
    AxisSeries { coefficients: coefficients.to_vec(), remainder }
}

/// The axes as polynomials and their first derivatives from the motion, as source text.
fn polynomials((table, found): (&Table, &AxisMotion), name: &str, language: Language) -> Result<String, String> {
    let series = table.series.as_ref().ok_or("there are no polynomials to write as a function")?;
    let axes = table.axes.iter().zip(&series.axes);
    let polynomials: Vec<Polynomial<'_>> =
        axes.map(|(axis, coefficients)| Polynomial { name: &axis.name, coefficients }).collect();
    let mut comment = head(table);
    comment.extend(series.deviations.get(series.order).map(|most| {
        format!("the flank is off by up to {:.6} um where points were sampled; {}", most * 1e3, found.over())
    }));
    comment.extend(found.polynomials.as_ref().map(|found_polynomials| found.remainders_sentence(found_polynomials)));
    let signature = Signature { name, comment: &comment };
    Ok(emit_polynomials(language, signature, (&table.motions[0].name, series.about), &polynomials))
}

/// The same in closed form.
fn exact(
    (table, found): (&Table, &AxisMotion),
    carried: &Conversion<'_, '_>,
    name: &str,
    language: Language,
) -> Result<String, String> {
    let explicit = carried.explicit(false)?;
    let axes: Vec<(&str, Expr<'_>)> =
        table.axes.iter().map(|axis| axis.name.as_str()).zip(explicit.continuous.iter().copied()).collect();
    let mut comment = head(table);
    comment.push(format!(
        "exact but for rounding: within {:.1e} mm or rad of {} solved positions; {}",
        explicit.off,
        table.positions.len(),
        found.over()
    ));
    let motion = carried.source.motions[0].variable;
    emit_function(language, Signature { name, comment: &comment }, &[motion], &axes).map_err(|error| error.to_string())
}

fn head(table: &Table) -> Vec<String> {
    vec![
        format!("job {}: {}", table.of.job, table.carried),
        "mm and rad; derivatives per rad (mm) of the motion".to_string(),
    ]
}
