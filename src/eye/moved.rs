//! A look with a moved gaze: light is resampled on its way to the retina, p on its way back.

use rayon::prelude::*;

use super::Eye;
use super::context::{LookContext, illuminate, thirds, write_percept};
use super::field::Field;
use super::illuminance::IlluminanceOperator;
use super::percept::PerceptScratch;
use super::stats::LookStats;
use crate::kernel::{self, TILE, TileScratch};
use crate::light::Sample;

impl Eye {
    /// The light's way to the retina: cone illuminance of the picture, resampled to the places,
    /// moves their pigment.
    pub(super) fn expose(
        &mut self,
        context: &LookContext<'_>,
        operator: &IlluminanceOperator,
    ) -> LookStats {
        if context.step.is_idle() {
            return LookStats::EMPTY;
        }
        let ([width, height], shift, around) = (self.size, context.shift, context.around);
        self.fields.resize(3 * width * height, 0.0);
        let stats = illuminate(context.retinal, operator, &mut self.fields);
        let stats = stats.and(LookStats::of_light(context.greatest_around()));
        let field = Field { samples: &self.fields, width, height, around };
        let ([x0, y0], [places, _]) = (self.retina.origin(), self.retina.size());
        let rows = self.retina.par_rows_mut().zip(self.plan.ledger.rows_mut()).enumerate();
        let moved =
            rows.map_init(TileScratch::new, |TileScratch { td, .. }, (row, (p, ledger))| {
                let mut stats = LookStats::EMPTY;
                for ((from, width), bound) in kernel::tiles(operator.tile(), places).zip(ledger) {
                    let at =
                        [(x0 + from as i64) as f64 + shift[0], (y0 + row as i64) as f64 + shift[1]];
                    field.resample(at, td.each_mut().map(|td| &mut td[..width]));
                    let td = td.each_ref().map(|td| &td[..width]);
                    let p = thirds(p).map(|p| &mut p[from..from + width]);
                    let greatest = td.map(kernel::greatest);
                    stats = stats.and(context.step.tile(&context.rule, bound, td, greatest, p));
                }
                stats
            });
        stats.and(moved.reduce(|| LookStats::EMPTY, LookStats::and))
    }

    /// Makes places of their own of those that the picture covers for the first time. They go on
    /// with the bound of all that lies beyond.
    pub(super) fn grow(&mut self, shift: [f64; 2], tile: usize) {
        let edge = |i: usize| {
            let end = (self.size[i] as f64 - 1.0 - shift[i]).ceil() as i64;
            [(-shift[i]).floor() as i64, end]
        };
        let ([left, right], [top, bottom]) = (edge(0), edge(1));
        let before = self.retina.size();
        let first = self.retina.cover([left, top], [right, bottom], tile);
        let [width, height] = self.retina.size();
        if [width, height] != before {
            self.plan.ledger.grow(first, [width.div_ceil(tile), height]);
        }
    }

    /// Moves what no picture has covered, unless it may be left untouched.
    pub(super) fn advance_beyond(&mut self, context: &LookContext<'_>) {
        let bound = self.plan.ledger.beyond_mut();
        *bound = context.rule.after(*bound, context.greatest_around());
        if bound.is_infinite() {
            self.retina.advance_beyond(&context.step, context.around, context.shift);
        }
    }

    /// The percept's way back: p is read at the picture's points, and the picture's own light is
    /// seen through it.
    pub(super) fn perceive<T: Sample>(
        &self,
        context: &LookContext<'_>,
        operator: &IlluminanceOperator,
        percept: &mut [T],
    ) -> LookStats {
        let (shift, pigment) = (context.shift, self.pigment());
        let planes = context.shown.unwrap_or(context.retinal);
        let [x0, y0] = self.retina.origin();
        let rows = percept.par_chunks_exact_mut(3 * planes.width).enumerate();
        let of_row = rows.map_init(TileScratch::new, |scratch, (y, out)| {
            let TileScratch { light: room, td, lms, rgb } = scratch;
            let mut p = [[0.0; TILE]; 3];
            let mut limited = 0;
            for (from, width) in operator.tiles(planes.width) {
                let light = operator.light(planes.row(y), from, width, room);
                let at = [from as f64 - shift[0] - x0 as f64, y as f64 - shift[1] - y0 as f64];
                pigment.resample(at, p.each_mut().map(|p| &mut p[..width]));
                let p = p.each_ref().map(|p| &p[..width]);
                let scratch = PerceptScratch { p: td, lms, rgb };
                limited += write_percept(self.percept.see(light, p, scratch), out, from);
            }
            LookStats::of_percept(limited)
        });
        of_row.reduce(|| LookStats::EMPTY, LookStats::and)
    }
}
