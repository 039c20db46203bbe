% Psychtoolbox's ComputePhotopigmentBleaching on the light histories: octave peers.m histories.csv
% It steps by forward Euler at a fixed unit of time, and returns p at the start of every step.
addpath ("/usr/share/psychtoolbox-3/PsychColorimetric");
table = fopen (argv (){1});
fgetl (table);
rows = textscan (table, "%s %f %f", "Delimiter", ",");
fclose (table);
for scene = unique (rows{1}, "stable")'
  of_it = strcmp (rows{1}, scene{1});
  light = rows{2}(of_it);
  truth = rows{3}(of_it);
  for unit = {"hundredth", "msec", "tenthmsec"; 4, 40, 400}
    steps = unit{2};
    irradiance = [repelem(light, steps); light(end)];
    seconds = zeros (1, 3);
    for i = 1:3
      tic;
      bleached = ComputePhotopigmentBleaching (irradiance, "cones", "trolands", "Boynton", 0, unit{1});
      seconds(i) = toc;
    end
    p = 1 - bleached((1:numel (light))' * steps + 1);
    worst = max (abs (p - truth));
    note = "";
    if (! (worst < 2))
      note = "diverges";
    end
    printf ("Psychtoolbox ComputePhotopigmentBleaching,%s,%s: %d steps a frame,%.2e,%.1f,%s\n", scene{1}, unit{1}, ...
            steps, worst, median (seconds) * 1e9 / numel (light), note);
  end
end
