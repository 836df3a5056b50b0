{
 "version": "1.8.0",
 "simulation": {
  "name": "hand-written example",
  "rocket": {
   "mass": 14.0,
   "motor": {
    "dry_mass": 1.0
   },
   "parachutes": [
    {
     "name": "Main",
     "cd_s": 8.0,
     "trigger": "80049500",
     "sampling_rate": 100,
     "lag": 1.2,
     "noise": [0, 8.3, 0.5]
    },
    {
     "name": "Drogue",
     "cd_s": 0.9,
     "trigger": "apogee",
     "sampling_rate": 100,
     "lag": 0.3,
     "noise": [0, 8.3, 0.5]
    }
   ]
  },
  "env": {
   "latitude": 39.39,
   "longitude": -8.29,
   "elevation": 100,
   "atmospheric_model_type": "standard_atmosphere",
   "gravity": {
    "source": [
     [0, 9.8],
     [1000, 9.797]
    ]
   },
   "wind_velocity_x": {
    "source": 3.0
   },
   "wind_velocity_y": {
    "source": 0.0
   }
  },
  "max_time_step": Infinity,
  "solution": [
   [0, 0, 0, 100, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0],
   [2, 0, 5, 250, 0, 4, 120, 1, 0, 0, 0, 0, 0, 0],
   [12, 20, 60, 900, 6, 8, 0, 1, 0, 0, 0, 0, 0, 0],
   [12.01, 20.06, 60.08, 900, 6, 8, -0.098, 1, 0, 0, 0, 0, 0, 0],
   [12.3, 21.8, 62.4, 899.6, 6, 8, -2.94, 1, 0, 0, 0, 0, 0, 0],
   [13, 26, 68, 895, 5, 6, -9.8, 1, 0, 0, 0, 0, 0, 0],
   [50, 140, 90, 600, 3, 0, -18.5, 1, 0, 0, 0, 0, 0, 0],
   [51.2, 143.6, 90, 577.8, 3, 0, -18.5, 1, 0, 0, 0, 0, 0, 0],
   [53, 149, 90, 560, 3, 0, -5.6, 1, 0, 0, 0, 0, 0, 0],
   [140, 410, 90, 105, 3, 0, -5.5, 1, 0, 0, 0, 0, 0, 0],
   [140.9, 412.7, 90, 100, 3, 0, -5.479, 1, 0, 0, 0, 0, 0, 0]
  ],
  "apogee_time": 12.0,
  "parachute_events": [
   [
    12.0,
    {
     "name": "Drogue",
     "cd_s": 0.9,
     "trigger": "apogee",
     "sampling_rate": 100,
     "lag": 0.3,
     "noise": [0, 8.3, 0.5]
    }
   ],
   [
    50.0,
    {
     "name": "Main",
     "cd_s": 8.0,
     "trigger": "80049500",
     "sampling_rate": 100,
     "lag": 1.2,
     "noise": [0, 8.3, 0.5]
    }
   ]
  ]
 }
}
