//! What a fit found, for people.

use std::fmt;

use flank_export::fixed;

use super::result::{AdjustedSetting, AdjustedSettings, FitResult, FittedEaseOff, RangeBound, SettingsDirection};
use crate::compare::deviation_result::GridPlace;
use crate::project::columns::aligned;
use crate::project::units;

/// Changes with a smaller share of the largest one's are left out.
const LARGE: f64 = 0.3;
/// Values are told with so many decimals, ...
const DECIMALS: i32 = 6;
/// ... or more, so that the largest of a setting has so many digits that count, ...
const DIGITS: i32 = 4;
/// ... but no more than this.
const MOST_DECIMALS: i32 = 15;

impl fmt::Display for FitResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let um = |value: f64| fixed(value, 3);
        let FitResult { job, flanks, share, .. } = self;
        let of = if self.identification.is_some() { "to" } else { "to a wanted ease-off from" };
        for flank in flanks {
            let (surface, frame, wanted, known) = (&flank.surface, &flank.frame, &flank.wanted, flank.known);
            writeln!(
                f,
                "fit of {job}.{surface} ({frame}) {of} {wanted}: {known} of {}",
                counted(flank.before_um.len())
            )?;
        }
        writeln!(f)?;
        if let (Some(deg), Some(mm)) = (self.turn_deg, self.turn_mm) {
            let [deg, mm] = [deg, mm].map(|value| fixed(value, 6));
            writeln!(f, "  turn about z  {deg} deg, {mm} mm on the circle through the middle")?;
        }
        if let Some(mm) = self.shift_mm {
            writeln!(f, "  shift along y {} mm", fixed(mm, 6))?;
        }
        if let Some(mm) = self.thicker_mm {
            let place = if self.shift_mm.is_some() { "" } else { " on that circle" };
            writeln!(f, "  thickness     {} mm more{place}, which does not count", fixed(mm, 6))?;
        }
        writeln!(f, "  before        rms {} um", um(self.before_um))?;
        if let Some(found) = &self.identification {
            writeln!(f, "  identified    rms {} um is left", um(found.left_um))?;
        }
        writeln!(f, "  corrected     rms {} um is predicted", um(self.predicted_um))?;
        if let Some(FittedEaseOff { wanted, reached: Some(reached) }) = &self.ease_off {
            for (name, of) in [("wanted", wanted), ("reached", reached)] {
                let [slopes, crownings] = [of.slopes_um, of.crownings_um].map(|both| both.map(um).join(" "));
                writeln!(f, "  {name:12}  slopes {slopes}, crownings {crownings}, bias {} um", um(of.bias_um))?;
            }
        }
        for kept in &self.kept {
            let where_it_is = match (kept.is_line, kept.at) {
                (true, _) => "both ends of the row through its middle".to_string(),
                (false, None) => "its middle".to_string(),
                (false, Some(GridPlace { row, column })) => format!("row {row}, column {column}"),
            };
            writeln!(f, "  kept          {} at {where_it_is}, to {} um", kept.surface, um(kept.off_um))?;
        }
        if let Some(order) = self.order {
            let what = if order == 1 { "slopes" } else { "slopes, crownings and bias" };
            writeln!(
                f,
                "  order {order}       rms {} um is left of {what}, which alone are fitted",
                um(self.correction.left_um)
            )?;
        }
        if let Some(scatter) = self.scatter_um {
            let leave_out = self.leave_out_um.map(|error| format!("; rows and columns left out: {} um", um(error)));
            writeln!(f, "  scatter       {} um{}", um(scatter), leave_out.unwrap_or_default())?;
        }
        if let Some(found) = &self.identification {
            writeln!(f, "\nidentification: the settings that make the measured flank\n\n{}", table(found, "found"))?;
        }
        let head = match &self.identification {
            Some(_) => {
                format!("correction: the settings that take {} % of the deviation away", fixed(100.0 * share, 0))
            }
            None => "correction: the settings that give the wanted ease-off".to_string(),
        };
        match self.correction.settings[..] {
            [] if self.identification.as_ref().is_some_and(|found| !found.settings.is_empty()) => {
                writeln!(f, "\ncorrection: only errors of the machine were looked for, and nothing is to be set")?;
            }
            _ => writeln!(f, "\n{head}\n\n{}", table(&self.correction, "new"))?,
        }
        if let Some(choice) = &self.choice {
            let all = choice.candidates.len();
            let (chosen, leave) = (self.correction.settings.len(), um(choice.all_leave_um));
            let settings = units::counted(all, "setting");
            write!(f, "\nchosen: {chosen} of {settings}; all of them would leave {leave} um by derivatives")?;
            match choice.noise_um {
                0.0 => writeln!(f)?,
                noise => writeln!(f, "; a point scatters by {} um", um(noise))?,
            }
        }
        writeln!(f, "\nwhat changes together move the flank by, um rms\n")?;
        self.directions.iter().try_for_each(|of| writeln!(f, "  {}", direction(of)))?;
        for told in &self.untold {
            writeln!(f, "\nnot told by the points: {told}")?;
        }
        if let Some(text) = &self.corrected {
            write!(f, "\n{text}")?;
        }
        if self.files.is_empty() { Ok(()) } else { writeln!(f, "\nwrote {}", self.files.join(", ")) }
    }
}

fn counted(points: usize) -> String {
    units::counted(points, "point")
}

fn table(of: &AdjustedSettings, new: &str) -> String {
    let head = ["setting", "now", "change", new, "", "at a bound", "moves it by um", "uncertain by"].map(String::from);
    let rows: Vec<[String; 8]> = [head].into_iter().chain(of.settings.iter().map(cells)).collect();
    aligned(&rows, "<>>>< >>").trim_end().to_string()
}

fn cells(of: &AdjustedSetting) -> [String; 8] {
    let bound = match of.at_bound {
        Some(RangeBound::Low) => "lower",
        Some(RangeBound::High) => "upper",
        None => "-",
    };
    let values = [of.now, of.change, of.new];
    let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    // curvatures of lines are some 1e-5 1/mm
    let digits = if largest > 0.0 { DIGITS - 1 - largest.log10().floor() as i32 } else { DECIMALS };
    let [now, change, new] = values.map(|value| fixed(value, digits.clamp(DECIMALS, MOST_DECIMALS) as usize));
    let uncertain = match (of.uncertain_by, of.at_bound) {
        (Some(by), _) => format!("{by:.2e}"),
        (None, Some(_)) => "-".to_string(),
        (None, None) if of.is_rounded => "rounded".to_string(),
        (None, None) => "not determined".to_string(),
    };
    [of.name.clone(), now, change, new, of.unit.clone(), bound.to_string(), fixed(of.moves_um, 3), uncertain]
}

fn direction(of: &SettingsDirection) -> String {
    let sign = |by: f64| if by < 0.0 { "" } else { "+" };
    let most = of.changes.iter().fold(0.0, |most: f64, part| most.max(part.share));
    let parts = of.changes.iter().filter(|part| part.share > LARGE * most).map(|part| {
        let text = format!("{}{:.2e} {}", sign(part.by), part.by, part.unit);
        format!("{} {}", part.name, text.trim_end())
    });
    let parts: Vec<String> = parts.collect();
    let used = if of.is_used { "" } else { "  (not used)" };
    format!("{:>9}  {}{used}", fixed(of.moves_um, 4), parts.join(", "))
}
