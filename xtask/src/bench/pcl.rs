//! The Point Cloud Library: small programs around it, built beside the data and run as processes of their own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use super::figures::Figures;
use crate::house::{files, is_installed, output};

/// The built programs.
pub(crate) struct Pcl {
    programs: PathBuf,
    out: PathBuf,
    /// Version of the package.
    pub(crate) version: String,
}

/// How many programs there are to run in turn.
pub(crate) const BLOCKS: usize = 3;

impl Pcl {
    /// Copies the sources to `folder` and builds them there with -O2, unless they are as they were.
    ///
    /// # Errors
    /// Without sources, the library or a compiler.
    pub(crate) fn build(sources: &Path, folder: &Path) -> Result<Self> {
        ensure!(sources.join("build.sh").is_file(), "no sources of the peers beside the data");
        ensure!(is_installed("g++"), "g++ is missing");
        let version =
            output(Command::new("dpkg-query").args(["--show", "--showformat=${Version}", "libpcl-dev"]))
                .context("libpcl-dev is missing")?;

        fs::create_dir_all(folder).with_context(|| format!("{}", folder.display()))?;
        let mut text = String::new();
        for ending in ["sh", "h", "cpp"] {
            for file in files(sources, ending)? {
                text += &fs::read_to_string(&file).with_context(|| format!("{}", file.display()))?;
                let name = file.file_name().context("a file without a name")?;
                fs::copy(&file, folder.join(name)).with_context(|| format!("{}", file.display()))?;
            }
        }
        let (stamp, programs) = (folder.join("build.stamp"), folder.join("build/o2"));
        if fs::read_to_string(&stamp).ok() != Some(text.clone()) {
            println!("building the programs around PCL");
            output(Command::new("bash").arg("build.sh").args(["build", "o2"]).current_dir(folder))?;
            fs::write(&stamp, text).with_context(|| format!("{}", stamp.display()))?;
        }
        Ok(Self { programs, out: folder.join("out"), version })
    }

    /// Runs one of the programs over every n-th frame of the folder that holds `learn`.
    ///
    /// # Errors
    /// When it fails, or prints nothing that is understood.
    pub(crate) fn run(&self, block: usize, learn: &Path, every: usize, figures: &mut Figures) -> Result<()> {
        let data = learn.parent().context("learn has no folder above it")?;
        let mut command = match block {
            // As tuned on mOSD learn: the table removed first.
            0 => self.program(
                "pcl_lccp",
                data,
                Some("lccp"),
                "tag=lccp sanity=0 table=pre tab_dist=0.007 concavity=15",
            ),
            1 => self.program(
                "pcl_tabletop",
                data,
                Some("omps"),
                "tag=omps mode=omps only_largest=1 pdist=0.01",
            ),
            _ => self.program("pcl_normals", data, None, "knn=0"),
        };
        let text = output(command.arg("split=learn").arg(format!("every={every}")))?;
        let times: Vec<_> = text.lines().filter_map(time).collect();
        ensure!(!times.is_empty(), "a peer printed no times");
        for (series, wall, cpu) in times {
            figures.add(format!("{series}/wall_ms"), wall);
            figures.add(format!("{series}/cpu_ms"), cpu);
        }
        Ok(())
    }

    fn program(&self, name: &str, data: &Path, out: Option<&str>, arguments: &str) -> Command {
        let mut command = Command::new(self.programs.join(name));
        // One thread: what is said to be parallel in these programs is OpenMP.
        command.env("OMP_NUM_THREADS", "1").arg(data).args(out.map(|out| self.out.join(out)));
        command.args(arguments.split_whitespace());
        command
    }
}

/// Reads a line `TIME tag  stage  n 45  wall 1.23  cpu 1.20 ms ..`: `tag/stage` and both medians. Angles are printed as walls.
fn time(line: &str) -> Option<(String, f64, f64)> {
    let (tag, rest) = line.strip_prefix("TIME ")?.split_once(' ')?;
    let (left, right) = rest.split_once("  wall ")?;
    let (stage, _count) = left.rsplit_once(" n ")?;
    let mut values = right.split_whitespace();
    let wall = values.next()?.parse().ok()?;
    let cpu = values.nth(1)?.parse().ok()?;
    Some((format!("{tag}/{}", stage.trim()), wall, cpu))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_off_the_lines_of_the_programs() {
        let line = "TIME pcl_normals                  deg to table AVERAGE_3D_GRADIENT n  45  wall      1.25  cpu      0.50 ms (median)  min cpu      0.00";
        let read = time(line).unwrap();
        assert_eq!(read, ("pcl_normals/deg to table AVERAGE_3D_GRADIENT".to_owned(), 1.25, 0.5));
        assert_eq!(time("== normals"), None);
        assert_eq!(time("TIME lccp TOTAL"), None);
    }
}
